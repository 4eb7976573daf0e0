#pragma once
// A field that grows evenly from place to place.
#include <array>

#include "parameter/parameter.hpp"
#include "parts/own_frame.hpp"

namespace rabiline {

/// How the field along its direction grows, without divergence or curl: the other components grow with it.
struct FieldGradient {
  double longitudinal = 0, transverse = 0, quadrupole = 0;  // [T/m]
  bool operator==(const FieldGradient&) const = default;
};
template <>
inline constexpr auto parameters<FieldGradient> = std::tuple{
    param("longitudinal", &FieldGradient::longitudinal, Dimension::field_gradient, range::any,
          "growth along the beam, from the middle of the field", 0.0),
    param("transverse", &FieldGradient::transverse, Dimension::field_gradient, range::any,
          "growth across the beam, across the field as well: towards +x for a field along +z, -z for one "
          "along +x",
          0.0),
    param("quadrupole", &FieldGradient::quadrupole, Dimension::field_gradient, range::any,
          "growth across the beam along the field, and as much decay of the component across both", 0.0),
};

/// dB_i/dx_k [T/m] in the laboratory, at [3 i + k].
using FieldSlopes = std::array<double, 9>;
/// Those of the field; its direction is along or across the beam. Across: with w
/// along the direction, y the beam and u = y x w: dB_w/dy = dB_y/dw, dB_w/du = dB_u/dw, dB_w/dw = -dB_u/du.
/// Along the beam, with u = x, w = z: dB_y/dy = -2 dB_u/du = -2 dB_w/dw, dB_y/du = dB_u/dy, dB_w/dw =
/// -dB_u/du.
FieldSlopes slopes_of(const FieldGradient&, const UnitVector& direction, const Tilt&);

}  // namespace rabiline
