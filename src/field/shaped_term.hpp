#pragma once
// Static fields that differ from place to place, as plain values: kernels of every instruction set read them.
// How large they are somewhere is in field/shaped_field.hpp.

namespace rabiline {

enum class ShapedKind {
  linear  // B = B_0 + G r, r from the term's origin
};

/// One field, in its own frame: an origin and three axes in the laboratory.
struct ShapedTerm {
  ShapedKind kind = ShapedKind::linear;
  double x = 0, y = 0, z = 0;                    // [m] the origin in the laboratory
  bool turned = false;                           // the axes are not those of the laboratory
  double axes[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  // its x, y and z axis, one after the other
  double field[3] = {};                          // [T] of a linear field at the origin
  double slope[9] = {};                          // [T/m] of a linear field: dB_i/dx_k at [3 i + k]
  int part = 0;                                  // whose field it is
  bool operator==(const ShapedTerm&) const = default;
};

}  // namespace rabiline
