#include "plan/level_questions.hpp"

#include "plan/level_history.hpp"

#include <algorithm>

#include "spin/majorana.hpp"
#include "transport/branches.hpp"

namespace rabiline {
LevelQuestions::LevelQuestions(const Beamline& beamline, const Species& species, const Sections& sections,
                               const SpinHistory& spins, bool straight, SampledTables& tables)
    : beamline_(beamline),
      species_(species),
      sections_(sections),
      spins_(spins),
      straight_(straight),
      quantum_(std::holds_alternative<QuantumLaw>(beamline.law)),
      tables_(tables) {}

const TransitionTable* LevelQuestions::transitions_before(const Plane& plane) const {
  const std::vector<LevelZone> zones = driven_zones(sections_.sections, spins_.known_before(plane), plane.y);
  if (zones.empty()) return nullptr;
  const SlownessRange range =
      slownesses_of(beamline_.source, species_.mass, steepest_before(plane, beamline_, sections_));
  return &tables_.transitions(*species_.structure, zones, range.from, range.to);
}

std::optional<LevelProjection> LevelQuestions::at_magnet(const Plane& plane) const {
  if (!quantum_) return std::nullopt;
  LevelProjection asked;
  asked.part = plane.part;
  asked.levels = species_.levels();
  if (species_.structure) {
    asked.transitions = transitions_before(plane);
    return asked.transitions != nullptr ? std::optional(asked) : std::nullopt;
  }
  asked.from_level = spins_.start_before(plane) == UnitVector{};
  asked.zones = spins_.zones_before_levels(plane);
  if (asked.from_level && asked.zones.empty()) return std::nullopt;
  asked.polynomials = majorana_table(species_.spin.twice).coefficients;
  return asked;
}

SpinStretch LevelQuestions::at_detector(const Plane& plane) const {
  SpinStretch stretch;
  stretch.part = plane.part;
  stretch.majorana = quantum_;
  stretch.levels = quantum_ ? species_.levels() : 2;
  if (quantum_ && species_.structure) {
    stretch.of_atom = true;
    stretch.transitions = transitions_before(plane);
    return stretch;
  }
  if (straight_) stretch.zones = quantum_ ? spins_.zones_before_levels(plane) : spins_.zones_before(plane);
  if (straight_ && quantum_) stretch.from_level = spins_.start_before(plane) == UnitVector{};
  if (stretch.levels > 2) stretch.polynomials = majorana_table(species_.spin.twice).coefficients;
  return stretch;
}

void split_projections(const Law& law, std::vector<Stage>& chain) {
  const auto* quantum = std::get_if<QuantumLaw>(&law);
  if (quantum == nullptr || quantum->outcomes == Outcomes::sample) return;
  const auto bookable = std::find_if_not(chain.rbegin(), chain.rend(), can_be_booked).base();
  const auto first = std::find_if(bookable, chain.end(), [](const Stage& stage) {
    return std::holds_alternative<LevelProjection>(stage);
  });
  if (first != chain.end()) std::get<LevelProjection>(*first).split = true;
}

}  // namespace rabiline
