#pragma once
// B and its nine derivatives at a place, of shaped terms, for any number type: what kernels and the host read
// is one formula. `Maths` (field/host_maths.hpp, field/lane_maths.hpp) has what it needs beyond + - * /.
#include "field/shaped_term.hpp"

namespace rabiline {

template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_of(const LinearShape& linear, Number x, Number y,
                                                         Number z) {
  const Number none = x - x;
  FieldHere<Number> here;
  for (int i = 0; i < 3; ++i) {
    const double* g = linear.slope + 3 * i;
    here.field[i] = x * g[0] + y * g[1] + z * g[2] + linear.field[i];
    for (int k = 0; k < 3; ++k) here.slope[3 * i + k] = none + g[k];
  }
  return here;
}

template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_in_own_frame(const ShapedTerm& term, Number x, Number y,
                                                                   Number z) {
  return with_shape(term, [&](const auto& shape) { return field_of<Maths>(shape, x, y, z); });
}

/// Adds one term's field at (x, y, z) of the laboratory.
template <class Maths, class Number>
[[gnu::always_inline]] inline void add_field(const ShapedTerm& term, Number x, Number y, Number z,
                                             FieldHere<Number>& sum) {
  const Number from[3] = {x - term.x, y - term.y, z - term.z};
  if (!term.turned) {
    const FieldHere<Number> here = field_in_own_frame<Maths>(term, from[0], from[1], from[2]);
    for (int i = 0; i < 3; ++i) sum.field[i] = sum.field[i] + here.field[i];
    for (int i = 0; i < 9; ++i) sum.slope[i] = sum.slope[i] + here.slope[i];
    return;
  }
  Number own[3];
  for (int i = 0; i < 3; ++i)
    own[i] = from[0] * term.axes[3 * i] + from[1] * term.axes[3 * i + 1] + from[2] * term.axes[3 * i + 2];
  const FieldHere<Number> here = field_in_own_frame<Maths>(term, own[0], own[1], own[2]);
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < 3; ++i) sum.field[i] = sum.field[i] + here.field[a] * term.axes[3 * a + i];
    for (int b = 0; b < 3; ++b)
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
          sum.slope[3 * i + k] =
              sum.slope[3 * i + k] + here.slope[3 * a + b] * (term.axes[3 * a + i] * term.axes[3 * b + k]);
  }
}

}  // namespace rabiline
