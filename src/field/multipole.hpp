#pragma once
#include "field/complex_number.hpp"
#include "field/field_here.hpp"

namespace rabiline {

/// Poles around the y axis of its frame: B_z - i B_x = B_0 ((z + i x)/R)^p of 2(p + 1) poles. On the line x =
/// 0, z > 0 the field points along +z.
struct MultipoleShape {
  int power;      // p
  double field;   // [T] B_0
  double radius;  // [m] R
  bool operator==(const MultipoleShape&) const = default;
};

template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_of(const MultipoleShape& poles, Number x, Number,
                                                         Number z) {
  const Number none = x - x;
  const double inverse = 1 / poles.radius;
  const ComplexNumber<Number> place{z * inverse, x * inverse};
  ComplexNumber<Number> lower{none + poles.field, none};  // B_0 (..)^(p - 1)
  for (int k = 1; k < poles.power; ++k) lower = lower * place;
  const ComplexNumber<Number> field = lower * place, slope = (poles.power * inverse) * lower;
  FieldHere<Number> here;
  for (Number& component : here.field) component = none;
  for (Number& component : here.slope) component = none;
  here.field[0] = none - field.im;
  here.field[2] = field.re;
  here.slope[0] = none - slope.re;
  here.slope[2] = here.slope[6] = none - slope.im;
  here.slope[8] = slope.re;
  return here;
}

}  // namespace rabiline
