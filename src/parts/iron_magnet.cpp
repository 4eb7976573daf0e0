#include "parts/iron_magnet.hpp"

#include <fmt/format.h>

#include "parts/magnet_rules.hpp"
#include "parts/wire_field.hpp"

namespace rabiline {
namespace {

/// The circle through (+-a, 0) and (0, top).
MagnetCircle pole_face(double a, double top, int free) {
  return {0, (top * top - a * a) / (2 * top), (top * top + a * a) / (2 * top), free};
}

}  // namespace

void contribute(const IronMagnet& part, const Placement& place, SectionBuilder& builder) {
  const double a = part.half_distance, height = part.beam_height.value_or(1.2 * a);
  MagnetWalls walls;
  walls.rectangle = true;
  walls.half_x = part.width / 2;
  walls.half_z = part.concave;
  walls.circles[0] = pole_face(a, part.convex, +1);
  walls.circles[1] = pole_face(a, part.concave, -1);
  contribute_two_wire(
      {place.at + part.length, two_wire_shape(part.field, a, height), walls, part.offset, part.tilt},
      part.fringe, place, builder);
}

std::vector<Fault> faults_of(const IronMagnet& part, const Placement& place) {
  std::vector<Fault> out = faults_of_fringe(part.fringe, RectangularProfile{}, place);
  if (part.convex < part.concave) return out;
  out.push_back({place.name, "convex",
                 fmt::format("`{}` has no gap: its convex pole reaches up to {}, its concave one down to {}",
                             place.name, pretty_quantity(part.convex, Dimension::length),
                             pretty_quantity(part.concave, Dimension::length)),
                 "`convex` is the smaller height"});
  return out;
}

}  // namespace rabiline
