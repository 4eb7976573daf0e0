#include "rules/part_effects.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "plan/plan.hpp"
#include "plan/stretches.hpp"
#include "rules/room.hpp"
#include "section/section_builder.hpp"

namespace rabiline {
namespace {

struct Effects {
  bool spins = false, paths = false;
};

/// The sections of its own field; none of what follows another part's clock, which is the same everywhere.
std::vector<Section> sections_of(const PlacedPart& part) {
  if (clock_of(part.part)) return {};
  SectionBuilder builder(Wall{});
  std::visit([&](const auto& any) { contribute(any, part.placement, builder); }, part.part);
  return builder.build().sections;
}
/// Whether B differs from place to place in it.
bool has_gradient(const PlacedPart& part) {
  return std::ranges::any_of(sections_of(part), &Section::has_shaped_fields);
}

bool is_map(const ShapedTerm& term) {
  return term.kind == ShapedKind::map || term.kind == ShapedKind::round_map;
}
/// Whether its field is interpolated at every step.
bool is_mapped(const PlacedPart& part) {
  return std::ranges::any_of(sections_of(part), [](const Section& section) {
    return std::ranges::any_of(section.shaped, is_map) ||
           std::ranges::any_of(section.swinging, is_map, &SwingingTerm::field) ||
           std::ranges::any_of(section.electric, is_map);
  });
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

/// Whether a part pushes atoms with levels: as a magnet, or where their levels are sorted.
bool sorts_atoms(int part, const Sections& sections, const std::vector<Stretch>& sorting) {
  const auto is_its = [&](const auto& thing) { return thing.part == part; };
  return std::ranges::any_of(sections.planes,
                             [&](const Plane& plane) {
                               return plane.part == part && std::holds_alternative<MagnetTerm>(plane.term);
                             }) ||
         std::ranges::any_of(sections.sections, [&](const Section& section) {
           return std::ranges::any_of(section.shaped, is_its) &&
                  std::ranges::any_of(sorting, [&](const Stretch& stretch) {
                    return stretch.begin <= section.begin && section.end <= stretch.end;
                  });
         });
}

/// What each part does to any of the species; nothing where it has no field.
std::vector<Effects> effects_of_parts(const Beamline& beamline) {
  std::vector<Effects> all(beamline.parts.size());
  const Sections sections = sections_of(beamline);
  for (const Component& component : beamline.species) {
    const Species& species = component.species;
    const bool of_atom = law_traits(beamline.law).has_levels && species.structure && species.charge == 0;
    const std::vector<Stretch> sorting =
        of_atom ? flown_in_steps(stretches_of(beamline, species, sections), beamline.law, species)
                : std::vector<Stretch>{};
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!traits_of(beamline.parts[i].part).field) continue;
      const Effects one = effects_of(beamline.parts[i], beamline.law, species);
      all[i].spins |= one.spins;
      all[i].paths |= one.paths && (!of_atom || sorts_atoms(static_cast<int>(i), sections, sorting));
    }
  }
  return all;
}

}  // namespace

std::vector<bool> parts_that_move_paths(const Beamline& beamline) {
  std::vector<bool> out;
  for (const Effects& effects : effects_of_parts(beamline)) out.push_back(effects.paths);
  return out;
}

std::string report_of_parts(const Beamline& beamline) {
  std::string out;
  const std::vector<Effects> effects = effects_of_parts(beamline);
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const PlacedPart& part = beamline.parts[i];
    if (!traits_of(part.part).field) continue;
    const Effects& all = effects[i];
    out +=
        fmt::format("  {:<16} {:<16} {}{}\n", part.placement.name, kind_of(part.part),
                    all.spins && all.paths ? "turns spins and moves particles"
                    : all.spins            ? "turns spins"
                    : all.paths            ? "moves particles"
                                           : "does nothing to what flies",
                    (all.spins || all.paths) && is_mapped(part)
                        ? "; a step through its map takes some 30 times one through two wires in closed form"
                        : "");
  }
  return out.empty() ? out : "what the fields do\n" + out;
}

}  // namespace rabiline
