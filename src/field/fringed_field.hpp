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

/// A function and its derivatives over factorials: the beginning of its Taylor series. `Value` is a Number or
/// a ComplexNumber.
template <class Value, int n>
struct Taylor {
  Value c[n];
};
template <class Value, int n>
[[gnu::always_inline]] inline Taylor<Value, n> operator*(const Taylor<Value, n>& a,
                                                         const Taylor<Value, n>& b) {
  Taylor<Value, n> out;
  for (int i = 0; i < n; ++i) {
    out.c[i] = a.c[0] * b.c[i];
    for (int k = 1; k <= i; ++k) out.c[i] = out.c[i] + a.c[k] * b.c[i - k];
  }
  return out;
}

template <class Number>
[[gnu::always_inline]] inline Number real_part(Number x) {
  return x;
}
template <class Number>
[[gnu::always_inline]] inline Number real_part(const ComplexNumber<Number>& x) {
  return x.re;
}
template <class Maths, class Mask, class Number>
[[gnu::always_inline]] inline Number choose(Mask mask, Number yes, Number no) {
  return Maths::select(mask, yes, no);
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

/// e^P: w' = P' w.
template <class Maths, class Value, int n>
[[gnu::always_inline]] inline Taylor<Value, n> exponential_of(const Taylor<Value, n>& exponent) {
  Taylor<Value, n> w;
  w.c[0] = bounded_exponential<Maths>(exponent.c[0]);
  for (int i = 1; i < n; ++i) {
    w.c[i] = exponent.c[1] * w.c[i - 1];
    for (int k = 2; k <= i; ++k) w.c[i] = w.c[i] + static_cast<double>(k) * (exponent.c[k] * w.c[i - k]);
    w.c[i] = (1.0 / i) * w.c[i];
  }
  return w;
}

/// f = 1/(1 + w), w = e^P: f (1 + w) = 1.
template <class Maths, class Value, int n>
[[gnu::always_inline]] inline Taylor<Value, n> enge_edge(const Taylor<Value, n>& s, const double* a) {
  Taylor<Value, n> exponent;
  for (int i = 0; i < n; ++i) exponent.c[i] = 0.0 * s.c[0];
  for (int power = 5; power >= 0; --power) {
    if (power < 5) exponent = exponent * s;
    exponent.c[0] = exponent.c[0] + a[power];
  }
  const Taylor<Value, n> w = exponential_of<Maths>(exponent);
  Taylor<Value, n> f;
  const Value inverse = inverse_of<Maths>(w.c[0] + 1.0);
  f.c[0] = inverse;
  for (int i = 1; i < n; ++i) {
    f.c[i] = w.c[1] * f.c[i - 1];
    for (int k = 2; k <= i; ++k) f.c[i] = f.c[i] + w.c[k] * f.c[i - k];
    f.c[i] = -1.0 * (inverse * f.c[i]);
  }
  return f;
}

template <class Maths, class Number>
[[gnu::always_inline]] inline void sine_and_cosine_of(Number x, Number& sine, Number& cosine) {
  Maths::sine_and_cosine(x, sine, cosine);
}
template <class Maths, class Number>
[[gnu::always_inline]] inline void sine_and_cosine_of(const ComplexNumber<Number>& x,
                                                      ComplexNumber<Number>& sine,
                                                      ComplexNumber<Number>& cosine) {
  const Number grown = bounded_exponential<Maths>(x.im), shrunk = 1.0 / grown;
  const Number even = 0.5 * (grown + shrunk), odd = 0.5 * (grown - shrunk);
  Number s, c;
  Maths::sine_and_cosine(x.re, s, c);
  sine = {s * even, c * odd};
  cosine = {c * even, s - s - s * odd};
}

/// sin(a) with its derivatives, a linear in z.
template <class Maths, class Value, int n>
[[gnu::always_inline]] inline Taylor<Value, n> sine_of(const Value& a, double slope) {
  Value sine, cosine;
  sine_and_cosine_of<Maths>(a, sine, cosine);
  const Value wave[4] = {sine, cosine, -1.0 * sine, -1.0 * cosine};
  Taylor<Value, n> out;
  double step = 1;
  for (int i = 0; i < n; ++i) {
    out.c[i] = step * wave[i % 4];
    step *= slope / (i + 1);
  }
  return out;
}

/// A function where low <= Re z <= high, and constants below and above.
template <class Maths, class Value, int n>
[[gnu::always_inline]] inline Taylor<Value, n> between(const Value& z, double low, double below, double high,
                                                       double above, const Taylor<Value, n>& f) {
  const Value nothing = 0.0 * z;
  const auto where = real_part(z), none = where - where;
  Taylor<Value, n> out;
  for (int i = 0; i < n; ++i)
    out.c[i] = choose<Maths>(where < none + low, nothing + (i == 0 ? below : 0.0),
                             choose<Maths>(where > none + high, nothing + (i == 0 ? above : 0.0), f.c[i]));
  return out;
}

/// (1 - sin(pi s))/2 for s = outwards (z - edge)/length.
template <class Maths, class Value, int n>
[[gnu::always_inline]] inline Taylor<Value, n> sine_edge(const Value& z, double edge, double length,
                                                         double outwards) {
  const double slope = outwards * 3.141592653589793 / length;
  Taylor<Value, n> f = sine_of<Maths, Value, n>(slope * (z + -edge), slope);
  for (int i = 0; i < n; ++i) f.c[i] = -0.5 * f.c[i];
  f.c[0] = f.c[0] + 0.5;
  return between<Maths>(z, edge - length / 2, outwards > 0 ? 1 : 0, edge + length / 2, outwards > 0 ? 0 : 1,
                        f);
}

/// The share of the whole field at z and its derivatives.
template <int n, class Maths, class Value>
[[gnu::always_inline]] inline Taylor<Value, n> fringed_share(const FringeShape& shape, const Value& z) {
  const double half = shape.half_length, inverse = 1 / shape.fringe;
  const Value nothing = 0.0 * z;
  if (shape.curve == FringeCurve::sine)
    return sine_edge<Maths, Value, n>(z, -half, shape.fringe, -1) *
           sine_edge<Maths, Value, n>(z, half, shape.fringe, 1);
  if (shape.curve == FringeCurve::half_sine) {
    const double slope = 3.141592653589793 / (2 * half);
    return between<Maths>(z, -half, 0, half, 0, sine_of<Maths, Value, n>(slope * (z + half), slope));
  }
  Taylor<Value, n> first, last;
  for (int i = 0; i < n; ++i) first.c[i] = last.c[i] = nothing;
  if (shape.curve == FringeCurve::gaussian) {
    first.c[0] = (-0.5 * inverse * inverse) * (z * z);
    first.c[1] = (-inverse * inverse) * z;
    if constexpr (n > 2) first.c[2] = nothing + -0.5 * inverse * inverse;
    return between<Maths>(z, -half, 0, half, 0, exponential_of<Maths>(first));
  }
  first.c[0] = -inverse * (z + half);
  last.c[0] = inverse * (z + -half);
  first.c[1] = nothing + -inverse;
  last.c[1] = nothing + inverse;
  return enge_edge<Maths>(first, shape.enge) * enge_edge<Maths>(last, shape.enge);
}

/// Across: B_x + i B_z = B_0 F(z + i x), exactly, as far from the axis as F is analytic: up to pi/2 lengths
/// of a tanh. Along: B_z = f - r^2 f''/4 + r^4 f''''/64, B_r = -r f'/2 + r^3 f'''/16 - r^5 f'''''/384, which
/// has no divergence; what is left out are r^6 f^(6)/2304 of B_z, and r^5 f^(6)/384 of the curl.
template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_of(const FringeShape& shape, Number x, Number y,
                                                         Number z) {
  const Number none = x - x;
  if (shape.along) {
    const auto f = fringed_share<6, Maths>(shape, z);
    const Number r2 = x * x + y * y, r4 = r2 * r2;
    const double b = shape.size;
    return about_axis<Maths>(x, y, b * (f.c[0] - 0.5 * r2 * f.c[2] + 0.375 * r4 * f.c[4]),
                             b * (0.375 * r2 * f.c[3] - 0.5 * f.c[1] - 0.3125 * r4 * f.c[5]),
                             b * (f.c[1] - 1.5 * r2 * f.c[3] + 1.875 * r4 * f.c[5]),
                             b * (1.5 * r2 * f.c[4] - f.c[2]));
  }
  const auto f = fringed_share<2, Maths>(shape, ComplexNumber<Number>{z, x});
  FieldHere<Number> here;
  for (Number& component : here.field) component = none;
  for (Number& component : here.slope) component = none;
  here.field[0] = shape.size * f.c[0].re;
  here.field[2] = shape.size * f.c[0].im;
  here.slope[2] = here.slope[6] = shape.size * f.c[1].re;
  here.slope[8] = shape.size * f.c[1].im;
  here.slope[0] = none - here.slope[8];
  return here;
}

}  // namespace rabiline
