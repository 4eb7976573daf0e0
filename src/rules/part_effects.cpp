#include "rules/part_effects.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "rules/room.hpp"
#include "section/section_builder.hpp"

namespace rabiline {
namespace {

struct Effects {
  bool spins = false, paths = false;
};

/// Whether B differs from place to place in it; of what follows another part's clock it does not.
bool has_gradient(const PlacedPart& part) {
  if (clock_of(part.part)) return false;
  SectionBuilder builder(Wall{});
  std::visit([&](const auto& any) { contribute(any, part.placement, builder); }, part.part);
  return std::ranges::any_of(builder.build().sections,
                             [](const Section& section) { return section.has_shaped_fields(); });
}

Effects effects_of(const PlacedPart& part, const Law& law, const Species& species) {
  const bool charged = species.charge != 0, has_moment = species.gyromagnetic_ratio != 0 || species.structure;
  const LawTraits traits = law_traits(law);
  if (is_electric(part.part)) {
    const bool spins = has_moment || species.electric_dipole_moment != 0;
    return {spins, traits.has_forces ? charged : spins && traits.kappa != 0};
  }
  if (!traits.has_forces) return {has_moment, has_moment && traits.kappa != 0};
  return {has_moment, charged || (has_moment && (is_magnet(part.part) || has_gradient(part)))};
}

}  // namespace

bool moves_paths(const PlacedPart& part, const Beamline& beamline) {
  return traits_of(part.part).field && std::ranges::any_of(beamline.species, [&](const Component& component) {
           return effects_of(part, beamline.law, component.species).paths;
         });
}

std::string report_of_parts(const Beamline& beamline) {
  std::string out;
  for (const PlacedPart& part : beamline.parts) {
    if (!traits_of(part.part).field) continue;
    Effects all;
    for (const Component& component : beamline.species) {
      const Effects one = effects_of(part, beamline.law, component.species);
      all.spins |= one.spins;
      all.paths |= one.paths;
    }
    out += fmt::format("  {:<16} {:<16} {}\n", part.placement.name, kind_of(part.part),
                       all.spins && all.paths ? "turns spins and moves particles"
                       : all.spins            ? "turns spins"
                       : all.paths            ? "moves particles"
                                              : "does nothing to what flies");
  }
  return out.empty() ? out : "what the fields do\n" + out;
}

}  // namespace rabiline
