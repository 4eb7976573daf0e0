#include "parts/two_wire_magnet.hpp"

#include <fmt/format.h>
#include <numbers>

#include "core/constants.hpp"
#include "parts/magnet_rules.hpp"
#include "parts/wire_field.hpp"

namespace rabiline {
namespace {

/// [T] at (0, h): (mu_0 I/pi) a/(a^2 + h^2).
double field_at_beam(const TwoWireMagnet& part, double height) {
  if (const auto* stated = std::get_if<FieldAtBeam>(&part.strength)) return stated->field;
  return constants::vacuum_permeability * std::get<WireCurrent>(part.strength).current / std::numbers::pi *
         part.half_distance / (part.half_distance * part.half_distance + height * height);
}

}  // namespace

void contribute(const TwoWireMagnet& part, const Placement& place, SectionBuilder& builder) {
  const double a = part.half_distance, height = part.beam_height.value_or(1.2 * a);
  MagnetWalls walls;
  walls.circles[0] = {a, 0, part.wire_radius, +1};
  walls.circles[1] = {-a, 0, part.wire_radius, +1};
  contribute_two_wire({place.at + part.length, two_wire_shape(field_at_beam(part, height), a, height), walls,
                       part.offset, part.tilt},
                      part.fringe, place, builder);
}

std::vector<Fault> faults_of(const TwoWireMagnet& part, const Placement& place) {
  std::vector<Fault> out = faults_of_fringe(part.fringe, RectangularProfile{}, place);
  if (part.wire_radius < part.half_distance) return out;
  out.push_back(
      {place.name, "wire_radius",
       fmt::format("the wires of `{}` touch each other: their radius is {} and half of their distance {}",
                   place.name, pretty_quantity(part.wire_radius, Dimension::length),
                   pretty_quantity(part.half_distance, Dimension::length)),
       "make them thinner, or `half_distance` larger"});
  return out;
}

}  // namespace rabiline
