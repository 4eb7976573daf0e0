#include "parts/field_gradient.hpp"

#include <cmath>

namespace rabiline {

FieldSlopes slopes_of(const FieldGradient& g, const UnitVector& direction, const Tilt& tilt) {
  // In the frame (u, y, w).
  const bool along = std::abs(direction.y) > 0.5;
  const double sign = along && direction.y < 0 ? -1 : 1;
  const Vector3 w = along ? Vector3{0, 0, 1} : Vector3{direction}, y{0, 1, 0}, u = cross(y, w);
  FieldSlopes own{};
  if (along) {
    own[0] = -g.quadrupole - sign * g.longitudinal / 2;
    own[1] = own[3] = sign * g.transverse;
    own[4] = sign * g.longitudinal;
    own[8] = g.quadrupole - sign * g.longitudinal / 2;
  } else {
    own[0] = -g.quadrupole;
    own[2] = own[6] = g.transverse;
    own[5] = own[7] = g.longitudinal;
    own[8] = g.quadrupole;
  }
  const Vector3 axes[] = {turned(u, tilt), turned(y, tilt), turned(w, tilt)};
  const auto component = [](const Vector3& v, int i) { return i == 0 ? v.x : i == 1 ? v.y : v.z; };
  FieldSlopes out{};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          out[3 * i + k] += component(axes[a], i) * own[3 * a + b] * component(axes[b], k);
  return out;
}

}  // namespace rabiline
