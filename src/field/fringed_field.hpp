#pragma once
// A field that rises and falls along the z axis of its frame, of the same direction all along it; what it is
// beside the axis follows from Maxwell's equations without currents.
#include "field/complex_number.hpp"
#include "field/field_here.hpp"

namespace rabiline {

enum class FringeCurve {
  enge,  // edges 1/(1 + exp(a_0 + a_1 s + ... + a_5 s^5)), s outwards from the edge in units of its length
  sine,  // edges (1 - sin(pi s))/2 where |s| < 1/2: half a sine from 1 to 0
  half_sine,  // cos(pi z/2h) from end to end, without edges
  gaussian    // exp(-(z/length)^2/2), cut at both ends
};

struct FringeShape {
  bool along;          // B on the axis points along z, else along x
  FringeCurve curve;   // how its size runs along z
  double size;         // [T] B_0 between the edges
  double half_length;  // [m] its edges are at z = -half_length and half_length
  double fringe;       // [m] unit of s, or the gaussian's standard deviation
  double enge[6];      // a
  bool operator==(const FringeShape&) const = default;
};

/// A function and its derivative. `Value` is a Number or a ComplexNumber.
template <class Value>
struct WithSlope {
  Value value, slope;
};
template <class Value>
[[gnu::always_inline]] inline WithSlope<Value> operator*(const WithSlope<Value>& a,
                                                         const WithSlope<Value>& b) {
  return {a.value * b.value, a.value * b.slope + a.slope * b.value};
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

/// e^P.
template <class Maths, class Value>
[[gnu::always_inline]] inline WithSlope<Value> exponential_of(const WithSlope<Value>& exponent) {
  const Value w = bounded_exponential<Maths>(exponent.value);
  return {w, exponent.slope * w};
}

/// f = 1/(1 + w), w = e^P: f' = -f w' f.
template <class Maths, class Value>
[[gnu::always_inline]] inline WithSlope<Value> enge_edge(const WithSlope<Value>& s, const double* a) {
  WithSlope<Value> exponent{0.0 * s.value + a[5], 0.0 * s.value};
  for (int power = 4; power >= 0; --power) {
    exponent = exponent * s;
    exponent.value = exponent.value + a[power];
  }
  const WithSlope<Value> w = exponential_of<Maths>(exponent);
  const Value f = inverse_of<Maths>(w.value + 1.0);
  return {f, -1.0 * (f * (w.slope * f))};
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
[[gnu::always_inline]] inline WithSlope<Value> sine_of(const Value& a, double slope, bool near) {
  WithSlope<Value> out;
  sine_and_cosine_of<Maths>(a, near, out.value, out.slope);
  return {out.value, slope * out.slope};
}

/// A function where low <= Re z <= high, and constants below and above.
template <class Maths, class Value>
[[gnu::always_inline]] inline WithSlope<Value> between(const Value& z, double low, double below, double high,
                                                       double above, const WithSlope<Value>& f) {
  const Value nothing = 0.0 * z;
  const auto where = z.re, none = where - where;
  const auto pieces = [&](double first, const Value& within, double last) {
    return choose<Maths>(where < none + low, nothing + first,
                         choose<Maths>(where > none + high, nothing + last, within));
  };
  return {pieces(below, f.value, above), pieces(0, f.slope, 0)};
}

/// (1 - sin(pi s))/2 for s = outwards (z - edge)/length.
template <class Maths, class Value>
[[gnu::always_inline]] inline WithSlope<Value> sine_edge(const Value& z, double edge, double length,
                                                         double outwards, bool near) {
  const double slope = outwards * 3.141592653589793 / length;
  const WithSlope<Value> wave = sine_of<Maths>(slope * (z + -edge), slope, near);
  return between<Maths>(z, edge - length / 2, outwards > 0 ? 1 : 0, edge + length / 2, outwards > 0 ? 0 : 1,
                        {-0.5 * wave.value + 0.5, -0.5 * wave.slope});
}

/// The share of the whole field at z.
template <class Maths, class Value>
[[gnu::always_inline]] inline WithSlope<Value> fringed_share(const FringeShape& shape, const Value& z) {
  const double half = shape.half_length, inverse = 1 / shape.fringe;
  const Value nothing = 0.0 * z;
  if (shape.curve == FringeCurve::sine)
    return sine_edge<Maths>(z, -half, shape.fringe, -1, shape.along) *
           sine_edge<Maths>(z, half, shape.fringe, 1, shape.along);
  if (shape.curve == FringeCurve::half_sine) {
    const double slope = 3.141592653589793 / (2 * half);
    return between<Maths>(z, -half, 0, half, 0, sine_of<Maths>(slope * (z + half), slope, shape.along));
  }
  if (shape.curve == FringeCurve::gaussian)
    return between<Maths>(z, -half, 0, half, 0,
                          exponential_of<Maths>(WithSlope<Value>{(-0.5 * inverse * inverse) * (z * z),
                                                                 (-inverse * inverse) * z}));
  const WithSlope<Value> first{-inverse * (z + half), nothing + -inverse},
      last{inverse * (z + -half), nothing + inverse};
  return enge_edge<Maths>(first, shape.enge) * enge_edge<Maths>(last, shape.enge);
}

/// Along: as Whittaker has harmonic functions with an axis (Math. Ann. 57, 333, 1903), B_z = 1/pi int F(z + i
/// r cos t) dt from 0 to pi and B_r = 1/pi int i cos t F(z + i r cos t) dt, whose series is f - r^2 f''/4 +
/// ... and -r f'/2 + .... Gauss and Chebyshev's 8 places in cos t, which come in conjugate pairs, leave out
/// r^16 f^(16) of it: of F with a pole at the distance d, (r/d)^16.
template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_along(const FringeShape& shape, Number x, Number y,
                                                            Number z) {
  constexpr double places[] = {0.9807852804032304, 0.8314696123025452, 0.5555702330196022,
                               0.1950903220161283};
  const Number none = x - x;
  const double least = 1e-9 * (shape.half_length + shape.fringe);  // instead of 0/0 on the axis
  const Number r = Maths::root(x * x + y * y + least * least);
  Number along = none, out = none, along_slope = none, out_slope = none;
  for (const double place : places) {
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

/// Across: B_x + i B_z = B_0 F(z + i x), exactly, as far from the axis as F is analytic: up to pi/2 lengths
/// of a tanh.
template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_of(const FringeShape& shape, Number x, Number y,
                                                         Number z) {
  if (shape.along) return field_along<Maths>(shape, x, y, z);
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
