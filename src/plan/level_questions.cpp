#include "plan/level_questions.hpp"

#include <algorithm>
#include <cmath>

#include "plan/level_history.hpp"
#include "plan/level_ways.hpp"
#include "spin/majorana.hpp"

namespace rabiline {
LevelQuestions::LevelQuestions(const Beamline& beamline, const Species& species, const Sections& sections,
                               const SpinHistory& spins, bool straight, SampledTables& tables)
    : beamline_(beamline),
      species_(species),
      sections_(sections),
      spins_(spins),
      straight_(straight),
      quantum_(law_traits(beamline.law).has_levels),
      tables_(tables) {}

const DrivenLevels* LevelQuestions::transitions_before(const Plane& plane) const {
  const std::vector<LevelZone> zones = driven_zones(sections_.sections, spins_.known_before(plane), plane.y);
  if (zones.empty()) return nullptr;
  // What steps are chosen for; with the slowness their error grows as its fifth power.
  const double slow = mean_speed(beamline_.source.speed, species_.mass) / 2;
  const double slowest = speed_range(beamline_.source.speed, species_.mass).slowest;
  return &tables_.transitions(*species_.structure, zones, 1 / std::max(slow, slowest));
}

void LevelQuestions::carry_levels(const Plane& plane, SpinPath& path) const {
  const double known = spins_.known_before(plane);
  if (!needs_way(sections_.sections, known, plane.y)) {
    path.transitions = transitions_before(plane);
    return;
  }
  const auto* magnet = std::get_if<MagnetTerm>(&plane.term);
  // One whose field points elsewhere from place to place has none on its axis, or spins follow it.
  const bool along_z = magnet != nullptr && magnet->shape.kind == MagnetKind::gradient;
  const LevelFields fields = level_fields(beamline_, species_, sections_.sections, known, plane.y,
                                          along_z ? std::abs(magnet->shape.field) : 0);
  path.way = &tables_.way(*species_.structure, fields);
}

std::optional<LevelProjection> LevelQuestions::at_plane(const Plane& plane, const UnitVector& axis) const {
  if (!quantum_) return std::nullopt;
  LevelProjection asked;
  asked.part = plane.part;
  asked.at = plane.y;
  asked.spins.levels = species_.levels();
  if (species_.structure) {
    carry_levels(plane, asked.spins);
    return asked.spins.is_idle() ? std::nullopt : std::optional(asked);
  }
  asked.spins.start = spins_.start_before(plane);
  asked.spins.axis = axis;
  asked.spins.zones = spins_.zones_before_levels(plane, asked.spins.axis);
  if (asked.spins.start && asked.spins.keeps_levels()) return std::nullopt;
  asked.spins.polynomials = majorana_table(species_.spin.twice).coefficients;
  return asked;
}

SpinStretch LevelQuestions::at_detector(const Plane& plane) const {
  SpinStretch stretch;
  stretch.part = plane.part;
  stretch.majorana = quantum_;
  SpinPath& spins = stretch.spins;
  spins.levels = quantum_ ? species_.levels() : 2;
  if (quantum_ && species_.structure) {
    spins.of_atom = true;
    carry_levels(plane, spins);
    return stretch;
  }
  if (straight_) spins.zones = quantum_ ? spins_.zones_before_levels(plane, {}) : spins_.zones_before(plane);
  if (straight_ && quantum_) spins.start = spins_.start_before(plane);
  if (spins.levels > 2) spins.polynomials = majorana_table(species_.spin.twice).coefficients;
  return stretch;
}

void split_projections(const Law& law, std::vector<Stage>& chain) {
  if (!law_traits(law).splits) return;
  const auto bookable = std::find_if_not(chain.rbegin(), chain.rend(), follows_paths).base();
  const auto first = std::find_if(bookable, chain.end(), [](const Stage& stage) {
    return std::holds_alternative<LevelProjection>(stage);
  });
  if (first != chain.end()) std::get<LevelProjection>(*first).split = true;
}

}  // namespace rabiline
