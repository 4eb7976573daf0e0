#include "parts/own_frame.hpp"

namespace rabiline {

OwnFrame turned_frame(const Tilt& tilt) {
  return {turned({1, 0, 0}, tilt), turned({0, 1, 0}, tilt), turned({0, 0, 1}, tilt)};
}

OwnFrame frame_along(const UnitVector& direction, const Tilt& tilt) {
  const Vector3 x = some_normal(direction);
  return {turned(x, tilt), turned(cross(direction, x), tilt), turned(direction, tilt)};
}

ShapedTerm placed(ShapedTerm term, const Vector3& origin, const OwnFrame& frame) {
  term.x = origin.x;
  term.y = origin.y;
  term.z = origin.z;
  int i = 0;
  for (const Vector3& axis : {frame.x, frame.y, frame.z})
    for (const double component : {axis.x, axis.y, axis.z}) term.axes[i++] = component;
  term.turned = !(frame.x == Vector3{1, 0, 0} && frame.y == Vector3{0, 1, 0} && frame.z == Vector3{0, 0, 1});
  return term;
}

}  // namespace rabiline
