// Falls that an experiment leaves out, and times.
#include <limits>

#include "plan/geometry.hpp"
#include "plan/plan.hpp"
#include "rules/warning_room.hpp"

namespace rabiline {
namespace {

/// The lowest opening that the beam passes or is caught by.
struct LowOpening {
  int part = -1;
  double height = std::numeric_limits<double>::infinity();  // [m] along z
};

double height_along_z(const Plane& plane) {
  const double endless = std::numeric_limits<double>::infinity();
  if (const auto* screen = std::get_if<ScreenTerm>(&plane.term)) return extent_of(screen->face).height;
  const auto* plate = std::get_if<PlateTerm>(&plane.term);
  if (plate == nullptr) return endless;
  const Aperture hole = aperture_of(plane.y, *plate);
  if (hole.stops_inside) return endless;
  return hole.radius >= 0 ? 2 * hole.radius : 2 * hole.half_z;
}

}  // namespace

Faults untold_falls_of(const Beamline& beamline) {
  constexpr double standard_gravity = 9.80665, share = 0.1;  // [m/s^2], of the opening
  if (beamline.gravity) return {};
  LowOpening passed, lowest;  // so far, and up to the last detector
  double last = 0;            // [m]
  for (const Plane& plane : sections_of(beamline).planes) {
    if (const double height = height_along_z(plane); height < passed.height) passed = {plane.part, height};
    if (!std::holds_alternative<ScreenTerm>(plane.term)) continue;
    lowest = passed;
    last = plane.y;
  }
  double speed = std::numeric_limits<double>::infinity();
  for (const Component& component : beamline.species)
    speed = std::min(speed, mean_speed(beamline.source.speed, component.species.mass));
  const double fall = standard_gravity / 2 * (last / speed) * (last / speed);
  if (!(fall > share * lowest.height)) return {};
  return {warning(
      "gravity", "",
      fmt::format(
          "nothing falls unless `gravity` is stated: at the mean speed particles would fall by {} up to {}, "
          "and the opening of `{}` is {} high",
          pretty_quantity(fall, Dimension::length), pretty_quantity(last, Dimension::length),
          beamline.parts[static_cast<std::size_t>(lowest.part)].placement.name,
          pretty_quantity(lowest.height, Dimension::length)),
      "write `gravity: 9.81 m/s^2` beside `parts`, with its `direction` where -z is not down, or `gravity: 0 "
      "m/s^2` to leave it out")};
}

Faults unpulsed_choppers_of(const Beamline& beamline) {
  Faults out;
  for (const PlacedPart& part : beamline.parts)
    if (std::holds_alternative<Chopper>(part.part) && beamline.source.rate && !beamline.source.pulse)
      out.push_back(
          warning(part.placement.name, "open",
                  fmt::format("all particles start at t = 0: behind `{}` rates are not those of a beam that "
                              "flows all the time",
                              part.placement.name),
                  "add `pulse: {shape: rectangle, length: ...}` to the source, as long as a period"));
  return out;
}

}  // namespace rabiline
