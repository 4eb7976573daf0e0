#include "parts/field_gradient.hpp"

#include <cmath>

namespace rabiline {

ShapedTerm gradient_term(const FieldGradient& g, const UnitVector& direction, const Tilt& tilt,
                         const Vector3& origin) {
  // In the frame (u, y, w).
  const bool along = std::abs(direction.y) > 0.5;
  const double sign = along && direction.y < 0 ? -1 : 1;
  const Vector3 w = along ? Vector3{0, 0, 1} : Vector3{direction}, y{0, 1, 0}, u = cross(y, w);
  LinearShape linear{};
  if (along) {
    linear.slope[0] = -g.quadrupole - sign * g.longitudinal / 2;
    linear.slope[1] = linear.slope[3] = sign * g.transverse;
    linear.slope[4] = sign * g.longitudinal;
    linear.slope[8] = g.quadrupole - sign * g.longitudinal / 2;
  } else {
    linear.slope[0] = -g.quadrupole;
    linear.slope[2] = linear.slope[6] = g.transverse;
    linear.slope[5] = linear.slope[7] = g.longitudinal;
    linear.slope[8] = g.quadrupole;
  }
  return placed(ShapedTerm(linear), origin, {turned(u, tilt), turned(y, tilt), turned(w, tilt)});
}

}  // namespace rabiline
