#pragma once
#include "field/field_here.hpp"

namespace rabiline {

/// A thin flat sheet, |x| < half_width of the plane y = 0 of its frame, in which an even current runs along
/// +z without an end.
struct FlatSheetShape {
  double half_width;  // [m]
  double strength;    // [T] mu_0 K/2 pi, K the current per width
  bool operator==(const FlatSheetShape&) const = default;
};

/// The sum of the fields of straight wires, mu_0 dI/(2 pi r^2) (-y, x):
/// B_x = -(mu_0 K/2 pi) times the angle under which the sheet is seen, with the sign of y;
/// B_y = (mu_0 K/2 pi) ln(r_left/r_right), from the edges at x = -half_width and +half_width.
/// B_x jumps by mu_0 K across the sheet and is zero in it. The logarithm's poles at the edges are flat within
/// 1e-6 of the half width.
template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_of(const FlatSheetShape& sheet, Number x, Number y,
                                                         Number /*z*/) {
  const double a = sheet.half_width, k = sheet.strength;
  const Number none = x - x, left = x + a, right = x - a, y2 = y * y + 1e-12 * a * a;
  const Number left2 = left * left + y2, right2 = right * right + y2;
  const Number size = Maths::select(y < none, none - y, y);
  // cot(angle) = (x^2 + y^2 - a^2)/(2 a |y|); in the plane itself the angle is pi or zero.
  const Number cotangent = (left * right + y * y) / (2.0 * a * size + 1e-300);
  const Number angle = 1.57079632679489662 - Maths::arctangent(cotangent);
  const Number side = Maths::select(y < none, none - 1.0, Maths::select(none < y, none + 1.0, none));
  const Number along = k * (left / left2 - right / right2), across = k * (y / left2 - y / right2);
  FieldHere<Number> here;
  here.field[0] = none - k * side * angle;
  here.field[1] = (0.5 * k) * Maths::logarithm(left2 / right2);
  here.slope[0] = none - across;
  here.slope[1] = here.slope[3] = along;
  here.slope[4] = across;
  here.field[2] = here.slope[2] = here.slope[5] = here.slope[6] = here.slope[7] = here.slope[8] = none;
  return here;
}

}  // namespace rabiline
