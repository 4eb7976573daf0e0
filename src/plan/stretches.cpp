#include "plan/stretches.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "plan/geometry.hpp"
#include "plan/magnets.hpp"
#include "plan/zones.hpp"

namespace rabiline {
namespace {

/// Below the first share of the smallest feature paths are one; beyond so many turns nothing is left of
/// phases.
constexpr double one_path = 0.01, no_phase = 100;

/// Integral of |grad |B|| along the beam at a place across it [T].
double gradient_along(const Sections& sections, const Stretch& stretch, double x, double z) {
  constexpr int places = 64;
  double sum = 0;
  for (const Section& section : sections.sections) {
    if (section.begin < stretch.begin || section.end > stretch.end) continue;
    const double step = (section.end - section.begin) / places;
    for (int i = 0; i < places; ++i) {
      FieldHere<double> here{};
      here.field[0] = section.field.x, here.field[1] = section.field.y, here.field[2] = section.field.z;
      for (const ShapedTerm& term : section.shaped)
        add_field<HostMaths>(term, x, section.begin + (i + 0.5) * step, z, here);
      const double *b = here.field, *g = here.slope, size = portable::hypot(b[0], b[1], b[2]);
      const auto grows = [&](int k) {
        return size > 0 ? (b[0] * g[k] + b[1] * g[3 + k] + b[2] * g[6 + k]) / size
                        : std::max({std::abs(g[k]), std::abs(g[3 + k]), std::abs(g[6 + k])});
      };
      sum += portable::hypot(grows(0), grows(1), grows(2)) * step;
    }
  }
  return sum;
}

double width_of(const Aperture& a) { return a.radius >= 0 ? 2 * a.radius : 2 * std::min(a.half_x, a.half_z); }

/// The smallest slit or bin behind a place [m].
double smallest_feature(const Sections& sections, double behind) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Plane& plane : sections.planes) {
    if (plane.y < behind) continue;
    if (const auto* plate = std::get_if<PlateTerm>(&plane.term))
      smallest = std::min(smallest, width_of(aperture_of(plane.y, *plate)));
    if (const auto* screen = std::get_if<ScreenTerm>(&plane.term)) {
      const Rectangle extent = extent_of(screen->face);
      smallest = std::min({smallest, extent.width / screen->bins_x, extent.height / screen->bins_z});
    }
  }
  return smallest;
}
/// The narrowest way of the beam up to a place, half of it: about its own size [m].
double beam_size(const Beamline& beamline, const Sections& sections, double before) {
  const auto* spot = std::get_if<GaussianSpot>(&beamline.source.opening);
  double size = spot != nullptr ? std::max(spot->sigma_x, spot->sigma_z)
                                : std::visit(
                                      [](const auto& hole) {
                                        if constexpr (requires { hole.width; })
                                          return std::max(hole.width, hole.height) / 2;
                                        else if constexpr (requires { hole.radius; })
                                          return hole.radius;
                                        else
                                          return 0.0;
                                      },
                                      beamline.source.opening);
  for (const Plane& plane : sections.planes)
    if (const auto* plate = std::get_if<PlateTerm>(&plane.term); plate && plane.y <= before)
      size = std::max(size, width_of(aperture_of(plane.y, *plate)) / 2);
  return size;
}

StretchOutlook outlook_of(const Beamline& beamline, const Species& species, const Sections& sections,
                          const Stretch& stretch) {
  StretchOutlook out;
  const LawTraits law = law_traits(beamline.law);
  if (!law.has_levels || species.charge != 0) return out;
  const double speed = mean_speed(beamline.source.speed, species.mass),
               size = beam_size(beamline, sections, stretch.begin),
               integral = std::max({gradient_along(sections, stretch, 0, 0),
                                    gradient_along(sections, stretch, size, 0),
                                    gradient_along(sections, stretch, 0, size)});
  const double moment = species.structure ? constants::bohr_magneton : std::abs(full_moment(species));
  double last = stretch.end;
  for (const Plane& plane : sections.planes)
    if (std::holds_alternative<ScreenTerm>(plane.term)) last = std::max(last, plane.y);
  const double pushed =
      2 * moment * integral / (species.mass * speed * speed);  // [1] of the two outer levels
  out.splitting = pushed * (last - (stretch.begin + stretch.end) / 2);
  out.feature = smallest_feature(sections, stretch.begin);
  out.turns = 2 * moment * integral * size / (constants::hbar * speed) / (2 * std::numbers::pi);
  if (out.splitting > one_path * out.feature) {
    out.between = out.turns <= no_phase;
    out.sorts = !out.between || !law.stays_coherent;
  }
  return out;
}

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

FieldCoupling level_coupling_of(const Beamline& beamline, const Species& species, SampledTables& tables) {
  FieldCoupling feels = coupling_of(beamline, species);
  feels.follows_level = true;
  feels.mass = species.mass;
  if (species.structure) {
    const MomentTable& table = tables.moments(*species.structure);
    feels.pull = table.largest() / species.mass;
    feels.moments = {table.coefficients().data(), table.cells(), table.scale()};
  }
  return feels;
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
  for (Stretch& stretch : stretches) stretch.outlook = outlook_of(beamline, species, sections, stretch);
  return stretches;
}

}  // namespace rabiline
