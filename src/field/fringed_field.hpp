#pragma once
// A field that rises and falls along the z axis of its frame; what it is beside the axis follows from
// Maxwell's equations without currents.
#include "field/complex_number.hpp"
#include "field/field_here.hpp"

namespace rabiline {

enum class FringeCurve {
  enge,  // edges 1/(1 + exp(a_0 + a_1 s + ... + a_5 s^5)), s outwards from the edge in units of its length
  sine,  // edges (1 - sin(pi s))/2 where |s| < 1/2: half a sine from 1 to 0
  half_sine,  // cos(pi z/2h) from end to end, without edges
  gaussian    // exp(-(z/length)^2/2), cut at both ends
};

/// Which way a field points: along z or along x on the axis, about it as that of 4, 6, ... poles does, or as
/// that of two wires beside it.
enum class FringeKind { along, across, poles, wires };

/// F(z), the curve of a field: `size (even + growth z) sin(turn z + phase)` times the curve of its edges.
struct FringeShape {
  FringeKind kind;
  FringeCurve curve;                     // of its edges
  double size;                           // [T]; [T/m^power] of poles
  double half_length;                    // [m] its edges are at z = -half_length and half_length
  double fringe;                         // [m] unit of s, or the gaussian's standard deviation
  double enge[6];                        // a
  double even = 1, growth = 0;           // 1, [1/m]
  double turn = 0, phase = 0;            // [rad/m], [rad]; no sine where turn is 0
  int power = 0;                         // of poles: B_x - i B_y = F (x + i y)^power where F is even
  double place[4]{}, share[4]{};         // of poles: where F is asked for, and for which part of its mean
  double half_distance = 0, height = 0;  // [m] of wires, at x = -height and y = -+half_distance
  bool operator==(const FringeShape&) const = default;
};

/// A function and its first two derivatives. `Value` is a Number or a ComplexNumber.
template <class Value>
struct WithSlopes {
  Value value, slope, bend;
};
template <class Value>
[[gnu::always_inline]] inline WithSlopes<Value> operator*(const WithSlopes<Value>& a,
                                                          const WithSlopes<Value>& b) {
  return {a.value * b.value, a.value * b.slope + a.slope * b.value,
          a.value * b.bend + 2.0 * (a.slope * b.slope) + a.bend * b.value};
}

template <class Maths, class Mask, class Number>
[[gnu::always_inline]] inline ComplexNumber<Number> choose(Mask mask, const ComplexNumber<Number>& yes,
                                                           const ComplexNumber<Number>& no) {
  return {Maths::select(mask, yes.re, no.re), Maths::select(mask, yes.im, no.im)};
}
template <class Maths, class Number>
[[gnu::always_inline]] inline Number inverse_of(Number x) {
  return 1.0 / x;
}
template <class Maths, class Number>
[[gnu::always_inline]] inline ComplexNumber<Number> inverse_of(const ComplexNumber<Number>& x) {
  const Number per_square = 1.0 / (x.re * x.re + x.im * x.im);
  return {x.re * per_square, x.re - x.re - x.im * per_square};
}
/// e^x, its real part kept between e^-300 and e^300 so that squares stay finite.
template <class Maths, class Number>
[[gnu::always_inline]] inline Number bounded_exponential(Number x) {
  const Number none = x - x;
  x = Maths::select(x > none + 300.0, none + 300.0, x);
  return Maths::exponential(Maths::select(x < none - 300.0, none - 300.0, x));
}
template <class Maths, class Number>
[[gnu::always_inline]] inline ComplexNumber<Number> bounded_exponential(const ComplexNumber<Number>& x) {
  const Number size = bounded_exponential<Maths>(x.re);
  Number sine, cosine;
  Maths::sine_and_cosine(x.im, sine, cosine);
  return {size * cosine, size * sine};
}

/// w = e^P: w'' = (P'' + P'^2) w.
template <class Maths, class Value>
[[gnu::always_inline]] inline WithSlopes<Value> exponential_of(const WithSlopes<Value>& p) {
  const Value w = bounded_exponential<Maths>(p.value);
  return {w, p.slope * w, (p.bend + p.slope * p.slope) * w};
}

/// f = 1/(1 + w), w = e^P: f' = -f w' f, f'' = -f w'' f - 2 f' w' f.
template <class Maths, class Value>
[[gnu::always_inline]] inline WithSlopes<Value> enge_edge(const WithSlopes<Value>& s, const double* a) {
  const Value nothing = 0.0 * s.value;
  WithSlopes<Value> exponent{nothing + a[5], nothing, nothing};
  for (int power = 4; power >= 0; --power) {
    exponent = exponent * s;
    exponent.value = exponent.value + a[power];
  }
  const WithSlopes<Value> w = exponential_of<Maths>(exponent);
  const Value f = inverse_of<Maths>(w.value + 1.0), slope = -1.0 * (f * (w.slope * f));
  return {f, slope, -1.0 * (f * (w.bend * f)) + -2.0 * (slope * (w.slope * f))};
}

/// `near`: of a small imaginary part every digit counts.
template <class Maths, class Number>
[[gnu::always_inline]] inline void sine_and_cosine_of(const ComplexNumber<Number>& x, bool near,
                                                      ComplexNumber<Number>& sine,
                                                      ComplexNumber<Number>& cosine) {
  const Number grown = bounded_exponential<Maths>(x.im), shrunk = 1.0 / grown;
  const Number even = 0.5 * (grown + shrunk);
  Number odd = 0.5 * (grown - shrunk);
  if (near) {
    const Number square = x.im * x.im;
    const Number series =
        1.0 + square * (1.0 / 6 + square * (1.0 / 120 + square * (1.0 / 5040 + square * (1.0 / 362880))));
    odd = Maths::select(square < 0.01 + (square - square), x.im * series, odd);
  }
  Number s, c;
  Maths::sine_and_cosine(x.re, s, c);
  sine = {s * even, c * odd};
  cosine = {c * even, s - s - s * odd};
}

/// sin(a), a linear in z.
template <class Maths, class Value>
[[gnu::always_inline]] inline WithSlopes<Value> sine_of(const Value& a, double slope, bool near) {
  Value sine, cosine;
  sine_and_cosine_of<Maths>(a, near, sine, cosine);
  return {sine, slope * cosine, (-slope * slope) * sine};
}

/// A function where low <= Re z <= high, and constants below and above.
template <class Maths, class Value>
[[gnu::always_inline]] inline WithSlopes<Value> between(const Value& z, double low, double below, double high,
                                                        double above, const WithSlopes<Value>& f) {
  const Value nothing = 0.0 * z;
  const auto where = z.re, none = where - where;
  const auto pieces = [&](double first, const Value& within, double last) {
    return choose<Maths>(where < none + low, nothing + first,
                         choose<Maths>(where > none + high, nothing + last, within));
  };
  return {pieces(below, f.value, above), pieces(0, f.slope, 0), pieces(0, f.bend, 0)};
}

/// (1 - sin(pi s))/2 for s = outwards (z - edge)/length.
template <class Maths, class Value>
[[gnu::always_inline]] inline WithSlopes<Value> sine_edge(const Value& z, double edge, double length,
                                                          double outwards, bool near) {
  const double slope = outwards * 3.141592653589793 / length;
  const WithSlopes<Value> wave = sine_of<Maths>(slope * (z + -edge), slope, near);
  return between<Maths>(z, edge - length / 2, outwards > 0 ? 1 : 0, edge + length / 2, outwards > 0 ? 0 : 1,
                        {-0.5 * wave.value + 0.5, -0.5 * wave.slope, -0.5 * wave.bend});
}

/// The curve of the edges.
template <class Maths, class Value>
[[gnu::always_inline]] inline WithSlopes<Value> edges_at(const FringeShape& shape, const Value& z) {
  const double half = shape.half_length, inverse = 1 / shape.fringe;
  const bool near = shape.kind != FringeKind::across;
  const Value nothing = 0.0 * z;
  if (shape.curve == FringeCurve::sine)
    return sine_edge<Maths>(z, -half, shape.fringe, -1, near) *
           sine_edge<Maths>(z, half, shape.fringe, 1, near);
  if (shape.curve == FringeCurve::half_sine) {
    const double slope = 3.141592653589793 / (2 * half);
    return between<Maths>(z, -half, 0, half, 0, sine_of<Maths>(slope * (z + half), slope, near));
  }
  if (shape.curve == FringeCurve::gaussian) {
    const double per_square = inverse * inverse;
    return between<Maths>(
        z, -half, 0, half, 0,
        exponential_of<Maths>(WithSlopes<Value>{(-0.5 * inverse * inverse) * (z * z),
                                                (-inverse * inverse) * z, nothing + -per_square}));
  }
  const WithSlopes<Value> first{-inverse * (z + half), nothing + -inverse, nothing},
      last{inverse * (z + -half), nothing + inverse, nothing};
  return enge_edge<Maths>(first, shape.enge) * enge_edge<Maths>(last, shape.enge);
}

/// F/size.
template <class Maths, class Value>
[[gnu::always_inline]] inline WithSlopes<Value> fringed_share(const FringeShape& shape, const Value& z) {
  WithSlopes<Value> share = edges_at<Maths>(shape, z);
  const Value nothing = 0.0 * z;
  if (shape.growth != 0)
    share = share * WithSlopes<Value>{shape.growth * z + shape.even, nothing + shape.growth, nothing};
  if (shape.turn != 0) share = share * sine_of<Maths>(shape.turn * z + shape.phase, shape.turn, true);
  return share;
}

/// cos t at 8 evenly spaced places from 0 to pi, of which the others are the negative ones.
inline constexpr double even_places[] = {0.9807852804032304, 0.8314696123025452, 0.5555702330196022,
                                         0.1950903220161283};

/// Along: as Whittaker has harmonic functions with an axis (Math. Ann. 57, 333, 1903), B_z = 1/pi int F(z + i
/// r cos t) dt from 0 to pi and B_r = 1/pi int i cos t F(z + i r cos t) dt, whose series is f - r^2 f''/4 +
/// ... and -r f'/2 + .... Gauss and Chebyshev's 8 places in cos t, which come in conjugate pairs, leave out
/// r^16 f^(16) of it: of F with a pole at the distance d, (r/d)^16.
template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_along(const FringeShape& shape, Number x, Number y,
                                                            Number z) {
  const Number none = x - x;
  const double least = 1e-9 * (shape.half_length + shape.fringe);  // instead of 0/0 on the axis
  const Number r = Maths::root(x * x + y * y + least * least);
  Number along = none, out = none, along_slope = none, out_slope = none;
  for (const double place : even_places) {
    const auto f = fringed_share<Maths>(shape, ComplexNumber<Number>{z, place * r});
    along = along + f.value.re;
    out = out - place * f.value.im;
    along_slope = along_slope + f.slope.re;
    out_slope = out_slope - place * f.slope.im;
  }
  const double mean = 0.25 * shape.size;
  const Number per_r = mean / r;
  return about_axis<Maths>(x, y, mean * along, per_r * out, mean * along_slope, per_r * out_slope);
}

/// A function of r and z with its slopes: by z, and by u = r^2.
template <class Number>
struct RoundFunction {
  Number g, g_z, g_zz, g_u, g_uz;
};

/// Adds the gradient of P g to a field, P + i Q = (x + i y)^n/n, where g obeys g_rr + (2n + 1) g_r/r + g_zz =
/// 0: the potential of 2n poles. `lower` is (x + i y)^(n - 2), which is not read where n is 1.
template <class Number>
[[gnu::always_inline]] inline void add_poles(FieldHere<Number>& here, double n,
                                             const ComplexNumber<Number>& lower,
                                             const ComplexNumber<Number>& flat,
                                             const ComplexNumber<Number>& w, Number r2,
                                             const RoundFunction<Number>& of) {
  const auto& [g, g_z, g_zz, g_u, g_uz] = of;
  const Number none = r2 - r2, g_uu = (none - (4 * n + 4) * g_u - g_zz) / (4.0 * r2);
  const ComplexNumber<Number> potential = (1 / n) * (flat * w);
  const Number p = potential.re, p_x = flat.re, p_y = none - flat.im, p_xx = (n - 1) * lower.re,
               p_xy = none - (n - 1) * lower.im, two_x = 2.0 * w.re, two_y = 2.0 * w.im;
  here.field[0] = here.field[0] + p_x * g + p * two_x * g_u;
  here.field[1] = here.field[1] + p_y * g + p * two_y * g_u;
  here.field[2] = here.field[2] + p * g_z;
  here.slope[0] = here.slope[0] + p_xx * g + 2.0 * p_x * two_x * g_u + p * (2.0 * g_u + two_x * two_x * g_uu);
  here.slope[1] = here.slope[1] + p_xy * g + (p_x * two_y + p_y * two_x) * g_u + p * two_x * two_y * g_uu;
  here.slope[2] = here.slope[2] + p_x * g_z + p * two_x * g_uz;
  here.slope[5] = here.slope[5] + p_y * g_z + p * two_y * g_uz;
  here.slope[8] = here.slope[8] + p * g_zz;
}

/// What Maxwell's equations say of the slopes that have not been added.
template <class Number>
[[gnu::always_inline]] inline void complete(FieldHere<Number>& here) {
  here.slope[3] = here.slope[1];
  here.slope[6] = here.slope[2];
  here.slope[7] = here.slope[5];
  here.slope[4] = (here.slope[0] - here.slope[0]) - here.slope[0] - here.slope[8];
}

/// Poles: g is F on the axis, and beside it the mean of F(z + i r cos t) with the weight (sin t)^(2n), by
/// Gauss and Gegenbauer's 8 places in cos t.
template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_of_poles(const FringeShape& shape, Number x, Number y,
                                                               Number z) {
  const Number none = x - x;
  const double least = 1e-9 * (shape.half_length + shape.fringe);  // instead of 0/0 on the axis
  const Number r2 = x * x + y * y + least * least, r = Maths::root(r2);
  RoundFunction<Number> g{none, none, none, none, none};
  for (int i = 0; i < 4; ++i) {
    const double place = shape.place[i], share = shape.share[i];
    const auto f = fringed_share<Maths>(shape, ComplexNumber<Number>{z, place * r});
    g.g = g.g + share * f.value.re;
    g.g_z = g.g_z + share * f.slope.re;
    g.g_zz = g.g_zz + share * f.bend.re;
    g.g_u = g.g_u - (place * share) * f.slope.im;
    g.g_uz = g.g_uz - (place * share) * f.bend.im;
  }
  const Number per_2r = 0.5 / r;
  g.g_u = g.g_u * per_2r;
  g.g_uz = g.g_uz * per_2r;
  ComplexNumber<Number> lower{none + shape.size, none};  // size (x + i y)^(power - 1)
  const ComplexNumber<Number> place{x, y};
  for (int k = 1; k < shape.power; ++k) lower = lower * place;
  FieldHere<Number> here;
  for (Number& component : here.field) component = none;
  for (Number& component : here.slope) component = none;
  add_poles(here, shape.power + 1.0, lower, lower * place, place, r2, g);
  complete(here);
  return here;
}

/// Two wires: B_x - i B_y = F/(1 + 2 h w/R^2 + w^2/R^2), w = x + i y, R^2 = a^2 + h^2, where F is even; its
/// powers of w up to the 15th are poles each of which has its own g. At 8 places t, evenly spaced, F(z + i r
/// cos t) is asked for, for all of them. Left out is (r/R)^16 of it, and r^16 f^(16) as of `along`.
template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_of_wires(const FringeShape& shape, Number x, Number y,
                                                               Number z) {
  const Number none = x - x;
  const double least = 1e-9 * (shape.half_length + shape.fringe);  // instead of 0/0 on the axis
  const Number r2 = x * x + y * y + least * least, r = Maths::root(r2), per_2r = 0.5 / r;
  RoundFunction<Number> at[4];
  for (int i = 0; i < 4; ++i) {
    const auto f = fringed_share<Maths>(shape, ComplexNumber<Number>{z, even_places[i] * r});
    const Number out = -even_places[i] * per_2r;
    at[i] = {f.value.re, f.slope.re, f.bend.re, out * f.slope.im, out * f.bend.im};
  }
  FieldHere<Number> here;
  for (Number& component : here.field) component = none;
  for (Number& component : here.slope) component = none;
  const ComplexNumber<Number> w{x, y};
  ComplexNumber<Number> lower{none, none}, flat{none + shape.size, none};  // size w^(n - 2), size w^(n - 1)
  const double per_r2 = 1 / (shape.half_distance * shape.half_distance + shape.height * shape.height);
  double coefficient = 1, before = 0, weights[4] = {1, 1, 1, 1};  // (sin t)^(2n)
  for (int n = 1; n <= 16; ++n) {
    double sum = 0;
    for (int i = 0; i < 4; ++i) {
      weights[i] *= 1 - even_places[i] * even_places[i];
      sum += weights[i];
    }
    RoundFunction<Number> g{none, none, none, none, none};
    for (int i = 0; i < 4; ++i) {
      const double share = weights[i] * (coefficient / sum);
      g.g = g.g + share * at[i].g;
      g.g_z = g.g_z + share * at[i].g_z;
      g.g_zz = g.g_zz + share * at[i].g_zz;
      g.g_u = g.g_u + share * at[i].g_u;
      g.g_uz = g.g_uz + share * at[i].g_uz;
    }
    add_poles(here, n, lower, flat, w, r2, g);
    lower = flat;
    flat = flat * w;
    const double next = -per_r2 * (2 * shape.height * coefficient + before);
    before = coefficient;
    coefficient = next;
  }
  complete(here);
  return here;
}

/// Across: B_x + i B_z = F(z + i x), exactly, as far from the axis as F is analytic: up to pi/2 lengths of a
/// tanh.
template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_of(const FringeShape& shape, Number x, Number y,
                                                         Number z) {
  if (shape.kind == FringeKind::along) return field_along<Maths>(shape, x, y, z);
  if (shape.kind == FringeKind::poles) return field_of_poles<Maths>(shape, x, y, z);
  if (shape.kind == FringeKind::wires) return field_of_wires<Maths>(shape, x, y, z);
  const Number none = x - x;
  const auto f = fringed_share<Maths>(shape, ComplexNumber<Number>{z, x});
  FieldHere<Number> here;
  for (Number& component : here.field) component = none;
  for (Number& component : here.slope) component = none;
  here.field[0] = shape.size * f.value.re;
  here.field[2] = shape.size * f.value.im;
  here.slope[2] = here.slope[6] = shape.size * f.slope.re;
  here.slope[8] = shape.size * f.slope.im;
  here.slope[0] = none - here.slope[8];
  return here;
}

}  // namespace rabiline
