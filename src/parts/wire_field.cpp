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
  MagnetTerm term = magnet;
  const Vector3 on_axis = two_wire_field_on_axis(term.shape, term.offset, term.tilt);
  if (is_boxed(fringe, RectangularProfile{})) {
    builder.uniform(place.at, term.end, {on_axis});
  } else {
    const FringeShape shape = shape_of(fringe, RectangularProfile{});
    const double length = term.end - place.at, c = portable::cos(term.tilt.y), s = portable::sin(term.tilt.y);
    FringedField alone(shape, place.at, length, {}), whole(shape, place.at, length, term.offset);
    alone.add(on_axis);
    alone.contribute(builder);
    whole.add_wires(term.shape, {{s, 0, c}, {c, 0, -s}, {0, 1, 0}});
    term.fringed = whole.terms();
  }
  builder.plane(place.at, term);
}

}  // namespace rabiline
