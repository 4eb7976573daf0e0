#include "parts/wire_field.hpp"

#include <cmath>

#include "core/portable_math.hpp"
#include "parts/own_frame.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

MagnetShape two_wire_shape(double field, double half_distance, double height) {
  MagnetShape shape;
  shape.kind = MagnetKind::two_wire;
  shape.field = field;
  shape.half_distance = half_distance;
  shape.height = height;
  return shape;
}

Vector3 two_wire_field_on_axis(const MagnetShape& shape, Offset offset, Roll tilt) {
  const double c = portable::cos(tilt.y), s = portable::sin(tilt.y), a = shape.half_distance;
  const double x = s * offset.z - c * offset.x, z = shape.height - s * offset.x - c * offset.z;
  const double right = 1 / ((x - a) * (x - a) + z * z), left = 1 / ((x + a) * (x + a) + z * z);
  const double size = shape.field * (a * a + shape.height * shape.height) / (2 * a);
  const double across = size * z * (right - left), up = size * ((x + a) * left - (x - a) * right);
  return {c * across + s * up, 0, c * up - s * across};
}

void contribute_two_wire(const MagnetTerm& magnet, const Fringe& fringe, const Placement& place,
                         SectionBuilder& builder) {
  const double c = portable::cos(magnet.tilt.y), s = portable::sin(magnet.tilt.y);
  contribute_magnet(
      magnet, fringe, place, two_wire_field_on_axis(magnet.shape, magnet.offset, magnet.tilt),
      [&](FringedField& whole) {
        whole.add_wires(magnet.shape, {{s, 0, c}, {c, 0, -s}, {0, 1, 0}});
      },
      builder);
}

}  // namespace rabiline
