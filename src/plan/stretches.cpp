#include "plan/stretches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "plan/beam.hpp"
#include "plan/geometry.hpp"
#include "plan/magnets.hpp"
#include "plan/zones.hpp"
#include "transport/mean_flight.hpp"

namespace rabiline {
namespace {

/// Below the first share of the smallest feature paths are one; beyond so many turns nothing is left of
/// phases.
constexpr double one_path = 0.01, no_phase = 100;
/// [m] An opening below it, such as a disc of 1 um, stands for a pencil beam and has no size of its own.
constexpr double smallest_spot = 5e-6;

FieldHere<double> field_beside(const Section& section, double x, double y, double z) {
  FieldHere<double> here{};
  here.field[0] = section.field.x, here.field[1] = section.field.y, here.field[2] = section.field.z;
  for (const ShapedTerm& term : section.shaped) add_field<HostMaths>(term, x, y, z, here);
  return here;
}
double tesla_of(const FieldHere<double>& b) { return portable::hypot(b.field[0], b.field[1], b.field[2]); }

/// Integral along the beam over a stretch; density(section, y).
template <class Density>
double integral_along(const Sections& sections, const Stretch& stretch, const Density& density) {
  constexpr int places = 64;
  double sum = 0;
  for (const Section& section : sections.sections) {
    if (section.begin < stretch.begin || section.end > stretch.end) continue;
    const double step = (section.end - section.begin) / places;
    for (int i = 0; i < places; ++i) sum += density(section, section.begin + (i + 0.5) * step) * step;
  }
  return sum;
}
/// What a particle of a unit of moment and mass is moved across the beam until it comes to `look`, by the
/// gradient of |B| across it at a place across it [T s^2/m]: what |B| changes by along the beam gives back
/// behind it the speed that it took.
double moved_across(const Sections& sections, const Stretch& stretch, const Offset& across,
                    const MeanFlight& flight, double look) {
  return integral_along(sections, stretch, [&](const Section& section, double y) {
    const FieldHere<double> here = field_beside(section, across.x, y, across.z);
    const double *b = here.field, *g = here.slope, size = tesla_of(here);
    const auto grows = [&](int k) {
      return size > 0 ? (b[0] * g[k] + b[1] * g[3 + k] + b[2] * g[6 + k]) / size
                      : std::max({std::abs(g[k]), std::abs(g[3 + k]), std::abs(g[6 + k])});
    };
    return portable::hypot(grows(0), grows(2), 0) * flight.time(y, look) / flight.speed_at(y);
  });
}
/// Integral over the time of how far |B| there is from that in its middle [T s].
double spread_along(const Sections& sections, const Stretch& stretch, const Offset& there,
                    const Offset& middle, const MeanFlight& flight) {
  return integral_along(sections, stretch, [&](const Section& section, double y) {
    return std::abs(tesla_of(field_beside(section, there.x, y, there.z)) -
                    tesla_of(field_beside(section, middle.x, y, middle.z))) /
           flight.speed_at(y);
  });
}

double width_of(const Aperture& a) { return a.radius >= 0 ? 2 * a.radius : 2 * std::min(a.half_x, a.half_z); }

/// The smallest bin of tallies [m]; that of an angle is one of places so far behind.
double smallest_bin(const std::vector<Tally>& tallies, double lever) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Tally& tally : tallies)
    for (const TallyAxis& axis : tally.axes) {
      const bool of_place = axis.quantity == Quantity::x || axis.quantity == Quantity::z,
                 of_angle = axis.quantity == Quantity::angle_x || axis.quantity == Quantity::angle_z ||
                            axis.quantity == Quantity::angle;
      if ((!of_place && !of_angle) || !axis.from || !axis.to || !axis.bins) continue;
      const double bin = std::abs(axis.to->value - axis.from->value) / static_cast<double>(*axis.bins);
      smallest = std::min(smallest, of_place ? bin : bin * lever);
    }
  return smallest;
}
const std::vector<Tally>* tallies_at(const Plane& plane) {
  if (const auto* screen = std::get_if<ScreenTerm>(&plane.term)) return &screen->tallies;
  const auto* monitor = std::get_if<MonitorTerm>(&plane.term);
  return monitor != nullptr && !monitor->tallies.empty() ? &monitor->tallies : nullptr;
}
/// Where places are asked about last [m].
double last_look(const Sections& sections, double last) {
  for (const Plane& plane : sections.planes)
    if (tallies_at(plane) != nullptr) last = std::max(last, plane.y);
  return last;
}

/// The smallest slit, or bin behind a place, and before the last look `lever` from where paths part [m].
double smallest_feature(const Sections& sections, double behind, double lever) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Plane& plane : sections.planes) {
    if (const auto* plate = std::get_if<PlateTerm>(&plane.term))
      smallest = std::min(smallest, width_of(aperture_of(plane.y, *plate)));
    if (plane.y < behind) continue;
    if (const auto* tallies = tallies_at(plane)) smallest = std::min(smallest, smallest_bin(*tallies, lever));
    if (const auto* screen = std::get_if<ScreenTerm>(&plane.term)) {
      const Rectangle extent = extent_of(screen->face);
      smallest = std::min({smallest, extent.width / screen->bins_x, extent.height / screen->bins_z});
    }
  }
  return smallest;
}
/// The smaller size of what particles start from [m].
double spot_of(const SourceOpening& opening) {
  const auto smaller = [](double a, double b) {
    const double infinite = std::numeric_limits<double>::infinity();
    return std::min(a < smallest_spot ? infinite : a, b < smallest_spot ? infinite : b);
  };
  if (const auto* spot = std::get_if<GaussianSpot>(&opening)) return smaller(spot->sigma_x, spot->sigma_z);
  if (const auto* disc = std::get_if<Disc>(&opening)) return smaller(2 * disc->radius, 2 * disc->radius);
  if (const auto* ring = std::get_if<Ring>(&opening))
    return smaller(ring->outer_radius - ring->inner_radius, 2 * ring->outer_radius);
  const auto& hole = std::get<Rectangle>(opening);
  return smaller(hole.width, hole.height);
}
/// [T] By how much |B| changes along the beam.
double change_along(const Sections& sections, const Stretch& stretch, const Offset& across) {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  integral_along(sections, stretch, [&](const Section& section, double y) {
    const double size = tesla_of(field_beside(section, across.x, y, across.z));
    least = std::min(least, size);
    most = std::max(most, size);
    return 0.0;
  });
  return std::max(most - least, 0.0);
}

StretchOutlook outlook_of(const Beamline& beamline, const Species& species, const Sections& sections,
                          const Stretch& stretch) {
  StretchOutlook out;
  const LawTraits law = law_traits(beamline.law);
  if (!law.has_levels || species.charge != 0) return out;
  const MeanFlight flight = mean_flight(beamline, species.mass);
  const BeamSpan beam = beam_at((stretch.begin + stretch.end) / 2, beamline, sections);
  const double look = last_look(sections, stretch.end), lever = look - (stretch.begin + stretch.end) / 2;
  double moved = moved_across(sections, stretch, beam.centre(), flight, look), spread = 0;
  for (const Offset& side : beam.sides()) {
    moved = std::max(moved, moved_across(sections, stretch, side, flight, look));
    spread = std::max(spread, spread_along(sections, stretch, side, beam.centre(), flight));
  }
  const double moment = species.structure ? constants::bohr_magneton : std::abs(full_moment(species));
  const double speed = flight.speed_between(stretch.begin, stretch.end);
  const double per_tesla = 2 * moment / (species.mass * speed * speed);  // of the two outer levels
  const double slowed = per_tesla * change_along(sections, stretch,
                                                 beam.centre());  // their difference in speed, in parts of it
  out.splitting = std::max(2 * moment / species.mass * moved, slowed > one_path ? slowed * lever : 0.0);
  out.feature = std::min(smallest_feature(sections, stretch.begin, lever), spot_of(beamline.source.opening));
  out.turns = 2 * moment * spread / constants::hbar / (2 * std::numbers::pi);
  if (out.splitting > one_path * out.feature) {
    out.between = out.turns <= no_phase;
    out.sorts = !out.between || !law.stays_coherent;
  }
  return out;
}

/// [T] All static fields on the beam's axis.
Vector3 field_on_axis(const Sections& sections, const Source& source, double y) {
  const Offset beam = axis_of_beam(source, y);
  for (const Section& section : sections.sections) {
    if (y < section.begin || y >= section.end) continue;
    FieldHere<double> here{};
    for (const ShapedTerm& term : section.shaped) add_field_at<HostMaths>(term, beam.x, y, beam.z, 0.0, here);
    return section.field + Vector3{here.field[0], here.field[1], here.field[2]};
  }
  return {};
}

/// That of the levels at one end of a stretch: the direction of the field where it has grown, seen from there
/// to the other end, and along z where it is hardly beside it.
UnitVector axis_at(const Sections& sections, const Source& source, double end, double other, double largest) {
  constexpr double beside = 0.01;  // [rad]
  constexpr int places = 1000;
  for (int i = 0; i <= places; ++i) {
    const auto b = direction_on_axis(sections, source, end + (other - end) * i / places, largest);
    if (!b) continue;
    if (portable::hypot(b->x, b->y) < beside) return {0, 0, b->z < 0 ? -1.0 : 1.0};
    return {b->x, b->y, b->z};
  }
  return {};
}

/// The hypothesis turns the velocity with the spin, whatever turns that.
ElectricCoupling electric_coupling_of(const Law& law, const Species& species) {
  const LawTraits traits = law_traits(law);
  const double charge_rate = species.charge / species.mass;
  return {.spin_per_motional = -species.gyromagnetic_ratio + charge_rate / 2,
          .spin_per_electric = -species.electric_dipole_moment / (species.spin.value() * constants::hbar),
          .turn_share = traits.kappa,
          .acceleration = traits.has_forces ? charge_rate : 0};
}

}  // namespace

bool asks_for_adiabaticity(const Beamline& beamline) {
  return std::ranges::any_of(beamline.parts, [](const PlacedPart& part) {
    const std::vector<Tally>* tallies = tallies_of(part.part);
    return tallies != nullptr && std::ranges::any_of(*tallies, [](const Tally& tally) {
             return std::ranges::any_of(tally.axes, [](const TallyAxis& axis) {
               return axis.quantity == Quantity::adiabaticity || axis.quantity == Quantity::adiabaticity_y;
             });
           });
  });
}

std::vector<Stretch> flown_in_steps(std::vector<Stretch> stretches, const Law& law, const Species& species) {
  if (law_traits(law).has_levels && species.structure)
    std::erase_if(stretches, [](const Stretch& stretch) { return !stretch.outlook.sorts; });
  return stretches;
}

FieldCoupling coupling_of(const Beamline& beamline, const Species& species) {
  FieldCoupling feels;
  const LawTraits law = law_traits(beamline.law);
  feels.spin_per_tesla = -species.gyromagnetic_ratio;
  feels.turn_per_tesla = turning_of(beamline.law, species).rate_per_tesla;
  if (law.has_forces) feels.pull = full_moment(species) / species.mass;
  feels.electric = electric_coupling_of(beamline.law, species);
  feels.levels = law.has_levels ? species.levels() : 0;
  feels.tolerance = law.tolerance;
  feels.watches_turning = asks_for_adiabaticity(beamline);
  if (const auto& gravity = beamline.gravity) {
    feels.gravity[0] = gravity->acceleration * gravity->direction.x;
    feels.gravity[1] = gravity->acceleration * gravity->direction.y;
    feels.gravity[2] = gravity->acceleration * gravity->direction.z;
  }
  return feels;
}

FieldCoupling level_coupling_of(const Beamline& beamline, const Species& species, const Stretch& stretch,
                                SampledTables& tables) {
  FieldCoupling feels = coupling_of(beamline, species);
  if (stretch.against_axis) feels.pull = -feels.pull;
  feels.follows_level = true;
  feels.mass = species.mass;
  if (species.structure) {
    const MomentTable& table = tables.moments(*species.structure);
    feels.pull = table.largest() / species.mass;
    feels.moments = {table.coefficients().data(), table.cells(), table.scale()};
  }
  return feels;
}

double largest_on_axis(const Sections& sections, const Source& source, const Stretch& stretch) {
  double largest = 0;
  for (const Section& section : sections.sections) {
    if (section.begin < stretch.begin || section.end > stretch.end) continue;
    const Vector3 b = field_on_axis(sections, source, (section.begin + section.end) / 2);
    largest = std::max(largest, portable::hypot(b.x, b.y, b.z));
  }
  return largest;
}

std::optional<Vector3> direction_on_axis(const Sections& sections, const Source& source, double y,
                                         double largest) {
  constexpr double weak = 0.01;  // of the largest
  const Vector3 b = field_on_axis(sections, source, y);
  const double size = portable::hypot(b.x, b.y, b.z);
  if (!(size > weak * largest)) return std::nullopt;
  return Vector3{b.x / size, b.y / size, b.z / size};
}

std::vector<Stretch> stretches_of(const Sections& sections) {
  std::vector<Stretch> stretches;
  for (const Section& section : sections.sections) {
    if (!section.needs_steps()) continue;
    if (!stretches.empty() && stretches.back().end == section.begin)
      stretches.back().end = section.end;
    else
      stretches.push_back({section.begin, section.end});
  }
  return stretches;
}

std::vector<Stretch> stretches_of(const Beamline& beamline, const Species& species,
                                  const Sections& sections) {
  std::vector<Stretch> stretches = stretches_of(sections);
  for (Stretch& stretch : stretches) {
    stretch.outlook = outlook_of(beamline, species, sections, stretch);
    if (!stretch.outlook.sorts || species.structure) continue;
    const double inside = 1e-9, largest = largest_on_axis(sections, beamline.source, stretch),
                 begin = stretch.begin + inside, end = stretch.end - inside;
    stretch.entrance = axis_at(sections, beamline.source, begin, end, largest);
    stretch.exit = axis_at(sections, beamline.source, end, begin, largest);
    if (!is_downwards(stretch.entrance)) continue;
    stretch.against_axis = true;
    stretch.entrance = -stretch.entrance;
    stretch.exit = -stretch.exit;
  }
  return stretches;
}

}  // namespace rabiline
