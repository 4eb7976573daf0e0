#pragma once
// Circular currents about the z axis of their frame, by the arithmetic-geometric mean.
#include "field/field_here.hpp"

namespace rabiline {

/// A thin ring around the origin.
struct LoopShape {
  double radius;  // [m]
  double field;   // [T] B_z in its middle, mu_0 N I/(2 radius)
  bool operator==(const LoopShape&) const = default;
};
/// A cylinder from z = -half_length to half_length in which an even current runs around.
struct SheetShape {
  double radius;       // [m]
  double half_length;  // [m]
  double field;        // [T] B_z were it endless, mu_0 N I/(2 half_length)
  bool operator==(const SheetShape&) const = default;
};

/// A number with its derivatives by u and z, as far as the field of a loop needs them.
template <class Number>
struct LoopJet {
  Number v, u, z, uz, zz;
  [[gnu::always_inline]] friend LoopJet operator+(const LoopJet& a, const LoopJet& b) {
    return {a.v + b.v, a.u + b.u, a.z + b.z, a.uz + b.uz, a.zz + b.zz};
  }
  [[gnu::always_inline]] friend LoopJet operator*(double s, const LoopJet& a) {
    return {s * a.v, s * a.u, s * a.z, s * a.uz, s * a.zz};
  }
  [[gnu::always_inline]] friend LoopJet operator*(const LoopJet& a, const LoopJet& b) {
    return {a.v * b.v, a.v * b.u + a.u * b.v, a.v * b.z + a.z * b.v,
            a.v * b.uz + a.uz * b.v + a.u * b.z + a.z * b.u, a.v * b.zz + a.zz * b.v + 2.0 * (a.z * b.z)};
  }
};
template <class Number>
[[gnu::always_inline]] inline LoopJet<Number> inverse(const LoopJet<Number>& a) {
  const Number r = 1.0 / a.v, r2 = r * r, nothing = r - r;
  return {r, nothing - a.u * r2, nothing - a.z * r2, r2 * (2.0 * (a.u * a.z) * r - a.uz),
          r2 * (2.0 * (a.z * a.z) * r - a.zz)};
}
template <class Maths, class Number>
[[gnu::always_inline]] inline LoopJet<Number> root_of(const LoopJet<Number>& a) {
  const Number root = Maths::root(a.v), half = 0.5 / root, u = half * a.u, z = half * a.z;
  return {root, u, z, half * (a.uz - 2.0 * (u * z)), half * (a.zz - 2.0 * (z * z))};
}

/// psi = A_phi/r of a loop of radius 1 with B_z = 1 in its middle, and its derivatives by u = r^2 and z. With
/// the distances far = sqrt((1 + r)^2 + z^2) and near = sqrt((1 - r)^2 + z^2), A_phi is the combination
/// (2 - k^2) K - 2 E, k^2 = 4 r/far^2 (J. D. Jackson, Classical Electrodynamics, 3rd ed., (5.37)). With the
/// mean M of (far, near) = (a_0, b_0), K = pi far/2M and (2 - k^2) K - 2 E = K sum over n > 0 of
/// 2^n c_n^2/far^2, c_n^2 = a_n^2 - b_n^2 (Abramowitz and Stegun, 17.6), c_1 = r/a_1, c_{n+1} =
/// c_n^2/4a_{n+1}: psi = (1/4M) sum 2^n w_n, w_n = c_n^2/u. It starts from a_1 and b_1, which are even in r,
/// so that nothing is divided by r. Five steps more give 1e-15 up to 1e-3 radii from the ring, whose inmost
/// 1e-6 is flat.
template <class Maths, class Number>
[[gnu::always_inline]] inline LoopJet<Number> loop_potential(Number u, Number z) {
  const Number none = u - u, one = none + 1.0, z2 = z * z, p = u + z2 - 1.0;
  Number product = p * p + 4.0 * z2;  // (near far)^2
  product = Maths::select(product > none + 1e-24, product, none + 1e-24);
  const LoopJet<Number> radicand{product, 2.0 * p, 4.0 * p * z + 8.0 * z, 4.0 * z, 8.0 * z2 + 4.0 * p + 8.0};
  const LoopJet<Number> near_far = root_of<Maths>(radicand);
  const LoopJet<Number> sum{u + z2 + 1.0, one, 2.0 * z, none, one + one};
  const LoopJet<Number> square = 0.5 * (sum + near_far), u_jet{u, one, none, none, none};
  LoopJet<Number> a = root_of<Maths>(square), b = root_of<Maths>(near_far), w = inverse(square);
  LoopJet<Number> series = 2.0 * w;
  double weight = 2;
#pragma GCC unroll 5
  for (int n = 0; n < 5; ++n) {
    const LoopJet<Number> mean = 0.5 * (a + b);
    b = root_of<Maths>(a * b);
    a = mean;
    weight *= 2;
    w = (1.0 / 16) * (w * w * u_jet * inverse(a * a));
    series = series + weight * w;
  }
  return 0.25 * (series * inverse(a));
}

template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_of(const LoopShape& loop, Number x, Number y,
                                                         Number z) {
  const double inverse = 1 / loop.radius, slope = loop.field * inverse;
  const Number u = (x * x + y * y) * (inverse * inverse), none = u - u;
  const LoopJet<Number> psi = loop_potential<Maths>(u, z * inverse);
  return about_axis<Maths>(x, y, (2.0 * loop.field) * (psi.v + u * psi.u), none - slope * psi.z,
                           (2.0 * slope) * (psi.z + u * psi.uz), none - (slope * inverse) * psi.zz);
}

/// Bulirsch's complete elliptic integral cel(k, g^2, 1, g), of (cos^2 + g sin^2)/((cos^2 + g^2 sin^2)
/// sqrt(cos^2 + k^2 sin^2)) from 0 to pi/2 (R. Bulirsch, Numer. Math. 13, 305 (1969)); `size` and `sign` are
/// those of g.
template <class Maths, class Number>
[[gnu::always_inline]] inline Number sheet_integral(Number k, Number size, Number sign) {
  Number c = sign / size + 1.0, q = k / size, s = 2.0 * (sign + q), p = q + size, em = k + 1.0;
#pragma GCC unroll 6
  for (int n = 0; n < 6; ++n) {
    const Number root = 2.0 * Maths::root(k), before = c;
    k = root * em;
    c = c + s / p;
    q = k / p;
    s = 2.0 * (s + before * q);
    p = q + p;
    em = root + em;
  }
  return 1.5707963267948966 * (s + c * em) / (em * (em + p));
}

/// B_z of a sheet of radius 1 from z = -infinity to `z`, but for what its far end adds, times pi/field, r
/// from its axis (N. Derby, S. Olbert, Am. J. Phys. 78, 229 (2010)). On the sheet itself B_z jumps.
template <class Maths, class Number>
[[gnu::always_inline]] inline Number sheet_end(Number r, Number z) {
  const Number none = r - r, outer = r + 1.0, far2 = outer * outer + z * z;
  const Number gap = 1.0 - r, sign = Maths::select(gap < none, none - 1.0, none + 1.0);
  Number size = sign * gap / outer;
  size = Maths::select(size > none + 1e-9, size, none + 1e-9);
  const Number inverse = 1.0 / Maths::root(far2);
  Number near2 = gap * gap + z * z;
  near2 = Maths::select(near2 > none + 1e-24, near2, none + 1e-24);
  return z * inverse * sheet_integral<Maths>(Maths::root(near2) * inverse, size, sign) / outer;
}

/// A sheet is a row of loops, so the derivatives of its field along z are the loops at its two ends.
template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_of(const SheetShape& sheet, Number x, Number y,
                                                         Number z) {
  const double inverse = 1 / sheet.radius, half = sheet.field / 2;
  const Number u = (x * x + y * y) * (inverse * inverse), r = Maths::root(u);
  const Number upper = (z + sheet.half_length) * inverse, lower = (z - sheet.half_length) * inverse;
  const LoopJet<Number> first = loop_potential<Maths>(u, upper), last = loop_potential<Maths>(u, lower);
  const Number along = sheet_end<Maths>(r, upper) - sheet_end<Maths>(r, lower);
  return about_axis<Maths>(x, y, (sheet.field * 0.3183098861837907) * along,
                           (half * inverse) * (last.v - first.v),
                           (2.0 * half * inverse) * (first.v + u * first.u - last.v - u * last.u),
                           (half * inverse * inverse) * (last.z - first.z));
}

}  // namespace rabiline
