// Deflecting magnets that nobody can build.
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/portable_math.hpp"
#include "plan/plan.hpp"
#include "plan/stretches.hpp"
#include "rules/warning_room.hpp"
#include "section/magnet_field.hpp"

namespace rabiline {
namespace {

/// [m] from the middle to the walls of its gap along the field of an even gradient, or what is told where it
/// has none.
double room_along(const MagnetTerm& magnet, double without_gap) {
  const MagnetWalls& walls = magnet.walls;
  return walls.rectangle
             ? std::abs(magnet.shape.along_x) * walls.half_x + std::abs(magnet.shape.along_z) * walls.half_z
             : without_gap;
}

/// [T] at the walls of its gap, or 1 mm from the beam where it has none; of others as it is stated.
double largest_field(const MagnetTerm& magnet) {
  const MagnetShape& shape = magnet.shape;
  if (shape.kind != MagnetKind::gradient) return std::abs(shape.field);
  return std::abs(shape.field) + std::abs(shape.gradient) * room_along(magnet, 1e-3);
}

double size_of(const Vector3& v) { return portable::hypot(v.x, v.y, v.z); }

/// Where the direction of the field jumps inside of a stretch, or where it begins, from one section to the
/// next: by more than a tenth of a radian, where neither is weak.
std::optional<double> first_jump(const Sections& sections, const Source& source, const Stretch& stretch,
                                 bool where_it_begins) {
  constexpr double beside = 1e-9, most = 0.1;  // [m], [rad]
  const double largest = largest_on_axis(sections, source, stretch);
  const auto direction_at = [&](double y) { return direction_on_axis(sections, source, y, largest); };
  for (const Section& s : sections.sections) {
    if (s.end < stretch.begin || (s.end == stretch.begin && !where_it_begins) || s.end >= stretch.end)
      continue;
    const auto before = direction_at(s.end - beside), behind = direction_at(s.end + beside);
    if (before && behind && size_of(*before - *behind) > most) return s.end;
  }
  return std::nullopt;
}

}  // namespace

Faults impossible_magnets_of(const Beamline& beamline) {
  Faults out;
  for (const Plane& plane : sections_of(beamline).planes) {
    const auto* magnet = std::get_if<MagnetTerm>(&plane.term);
    if (!magnet || !(largest_field(*magnet) > most_magnetic_field)) continue;
    const std::string& name = beamline.parts[static_cast<std::size_t>(plane.part)].placement.name;
    const bool gradient = magnet->shape.kind == MagnetKind::gradient;
    out.push_back(
        warning(name, gradient ? "gradient" : "field",
                fmt::format("the field of `{}` comes to {}{}: no magnet has more than {:.0f} T", name,
                            pretty_quantity(largest_field(*magnet), Dimension::magnetic_field),
                            !gradient                 ? ""
                            : magnet->walls.rectangle ? " at the walls of its gap"
                                                      : " 1 mm from the beam",
                            most_magnetic_field),
                gradient ? "a gradient in T/m, such as 1000 T/m" : ""));
  }
  return out;
}

Faults zeros_of_magnets_of(const Beamline& beamline) {
  constexpr double surely_met = 1e-4;  // [m] beside the axis
  Faults out;
  const Species* atom = atom_of(beamline);
  if (atom == nullptr) return out;
  for (const Plane& plane : sections_of(beamline).planes) {
    const auto* magnet = std::get_if<MagnetTerm>(&plane.term);
    if (magnet == nullptr || magnet->shape.kind != MagnetKind::gradient) continue;
    const double field = magnet->shape.field, gradient = magnet->shape.gradient;
    if (gradient == 0 || std::abs(field) > std::abs(gradient) * room_along(*magnet, surely_met)) continue;
    const std::string& name = beamline.parts[static_cast<std::size_t>(plane.part)].placement.name;
    out.push_back(warning(
        name, "field",
        fmt::format("the field of `{}` is 0 at {} from its middle: levels of `{}` are taken to follow it "
                    "through 0, without a flip, and are pushed back behind it",
                    name, pretty_quantity(std::abs(field / gradient), Dimension::length), atom->name),
        "a larger `field`, or a `gap` that ends before, keeps the beam away from there"));
  }
  return out;
}

Faults turned_magnets_of(const Beamline& beamline) {
  constexpr double most = 1e-2;  // [rad]
  Faults out;
  const Species* atom = atom_of(beamline);
  if (atom == nullptr) return out;
  for (const Plane& plane : sections_of(beamline).planes) {
    const auto* magnet = std::get_if<MagnetTerm>(&plane.term);
    if (magnet == nullptr) continue;
    const UnitVector axis = spin_axis(*magnet);
    const double angle = portable::atan2(std::abs(axis.x), axis.z);
    if (!(angle > most)) continue;
    const std::string& name = beamline.parts[static_cast<std::size_t>(plane.part)].placement.name;
    out.push_back(warning(
        name, "tilt",
        fmt::format("the field of `{}` stands at {} to +z: levels of `{}` are taken to follow it there and "
                    "back, without a flip",
                    name, pretty_quantity(angle, Dimension::angle), atom->name),
        "to see what flips, put the fields on the way into the file and let one overlap the magnet"));
  }
  return out;
}

Faults jumps_of_sorting_fields_of(const Beamline& beamline) {
  Faults out;
  if (!is_quantum(beamline)) return out;
  const Sections sections = sections_of(beamline);
  for (const Component& component : beamline.species) {
    const Species& species = component.species;
    for (const Stretch& stretch : stretches_of(beamline, species, sections)) {
      if (!stretch.outlook.sorts) continue;
      const std::optional<double> jump =
          first_jump(sections, beamline.source, stretch, species.structure.has_value());
      if (!jump) continue;
      const Section& first = *std::ranges::find_if(
          sections.sections, [&](const Section& s) { return s.begin >= stretch.begin && !s.shaped.empty(); });
      const std::string& name =
          beamline.parts[static_cast<std::size_t>(first.shaped.front().part)].placement.name;
      out.push_back(warning(
          name, "kind",
          fmt::format("`{}` sorts levels in a field whose direction jumps at {}: {} are taken to follow "
                      "it, without a flip",
                      name, metres(*jump), species.structure ? "levels" : "spins"),
          species.structure
              ? "fields of one direction, or a way without a field between them, ask for no flip"
              : "a fringe or a field between shows whether they do; `law: {name: quantum, "
                "outcomes: coherent}` follows each spin"));
    }
  }
  return out;
}

}  // namespace rabiline
