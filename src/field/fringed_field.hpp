#pragma once
// A field that rises and falls along the z axis of its frame, of the same direction all along it; what it is
// beside the axis follows from Maxwell's equations without currents.
#include "field/complex_number.hpp"
#include "field/field_here.hpp"

namespace rabiline {

enum class FringeCurve {
  enge,  // 1/(1 + exp(a_0 + a_1 s + ... + a_5 s^5)), s outwards from the edge in units of its length
  sine   // (1 - sin(pi s))/2 where |s| < 1/2: half a sine from 1 to 0
};

struct FringeShape {
  bool along;          // B on the axis points along z, else along x
  FringeCurve edge;    // how it falls at both ends
  double size;         // [T] B_0 between the edges
  double half_length;  // [m] its edges are at z = -half_length and half_length
  double fringe;       // [m] unit of s
  double enge[6];      // a
  bool operator==(const FringeShape&) const = default;
};

/// A function and its derivatives over factorials: the beginning of its Taylor series. `Value` is a Number or
/// a Complex.
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
[[gnu::always_inline]] inline Number real_part(const Complex<Number>& x) {
  return x.re;
}
template <class Maths, class Mask, class Number>
[[gnu::always_inline]] inline Number choose(Mask mask, Number yes, Number no) {
  return Maths::select(mask, yes, no);
}
template <class Maths, class Mask, class Number>
[[gnu::always_inline]] inline Complex<Number> choose(Mask mask, const Complex<Number>& yes,
                                                     const Complex<Number>& no) {
  return {Maths::select(mask, yes.re, no.re), Maths::select(mask, yes.im, no.im)};
}
template <class Maths, class Number>
[[gnu::always_inline]] inline Number inverse_of(Number x) {
  return 1.0 / x;
}
template <class Maths, class Number>
[[gnu::always_inline]] inline Complex<Number> inverse_of(const Complex<Number>& x) {
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
[[gnu::always_inline]] inline Complex<Number> bounded_exponential(const Complex<Number>& x) {
  const Number size = bounded_exponential<Maths>(x.re);
  Number sine, cosine;
  Maths::sine_and_cosine(x.im, sine, cosine);
  return {size * cosine, size * sine};
}

/// The derivatives of 1/(1 + e^P): with w = e^P, w' = P' w, and f (1 + w) = 1.
template <class Maths, class Value, int n>
[[gnu::always_inline]] inline Taylor<Value, n> enge_edge(const Taylor<Value, n>& s, const double* a) {
  Taylor<Value, n> exponent;
  for (int i = 0; i < n; ++i) exponent.c[i] = 0.0 * s.c[0];
  for (int power = 5; power >= 0; --power) {
    if (power < 5) exponent = exponent * s;
    exponent.c[0] = exponent.c[0] + a[power];
  }
  Taylor<Value, n> w, f;
  w.c[0] = bounded_exponential<Maths>(exponent.c[0]);
  for (int i = 1; i < n; ++i) {
    w.c[i] = exponent.c[1] * w.c[i - 1];
    for (int k = 2; k <= i; ++k) w.c[i] = w.c[i] + static_cast<double>(k) * (exponent.c[k] * w.c[i - k]);
    w.c[i] = (1.0 / i) * w.c[i];
  }
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
[[gnu::always_inline]] inline void sine_and_cosine_of(const Complex<Number>& x, Complex<Number>& sine,
                                                      Complex<Number>& cosine) {
  const Number grown = bounded_exponential<Maths>(x.im), shrunk = 1.0 / grown;
  const Number even = 0.5 * (grown + shrunk), odd = 0.5 * (grown - shrunk);
  Number s, c;
  Maths::sine_and_cosine(x.re, s, c);
  sine = {s * even, c * odd};
  cosine = {c * even, s - s - s * odd};
}

template <class Maths, class Value, int n>
[[gnu::always_inline]] inline Taylor<Value, n> sine_edge(const Taylor<Value, n>& s) {
  constexpr double pi = 3.141592653589793;
  const auto where = real_part(s.c[0]), none = where - where;
  const Value nothing = 0.0 * s.c[0];
  const auto inside = where<none - 0.5, outside = where> none + 0.5;
  const Value at = choose<Maths>(inside, nothing, choose<Maths>(outside, nothing, s.c[0]));
  Value sine, cosine;
  sine_and_cosine_of<Maths>(pi * at, sine, cosine);
  const Value wave[4] = {sine, cosine, -1.0 * sine, -1.0 * cosine};
  Taylor<Value, n> f;
  Value step = nothing + -0.5;
  for (int i = 0; i < n; ++i) {
    f.c[i] = step * wave[i % 4];
    if (i == 0) f.c[i] = f.c[i] + 0.5;
    f.c[i] = choose<Maths>(inside, i == 0 ? nothing + 1.0 : nothing, choose<Maths>(outside, nothing, f.c[i]));
    step = (pi / (i + 1)) * (step * s.c[1]);
  }
  return f;
}

/// The share of the whole field at z and its derivatives: an edge at either end.
template <int n, class Maths, class Value>
[[gnu::always_inline]] inline Taylor<Value, n> fringed_share(const FringeShape& shape, const Value& z) {
  const double inverse = 1 / shape.fringe;
  const Value nothing = 0.0 * z;
  Taylor<Value, n> first, last;
  for (int i = 0; i < n; ++i) first.c[i] = last.c[i] = nothing;
  first.c[0] = -inverse * (z + shape.half_length);
  last.c[0] = inverse * (z + -shape.half_length);
  first.c[1] = nothing + -inverse;
  last.c[1] = nothing + inverse;
  if (shape.edge == FringeCurve::sine) return sine_edge<Maths>(first) * sine_edge<Maths>(last);
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
  const auto f = fringed_share<2, Maths>(shape, Complex<Number>{z, x});
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
