#include "plan/level_questions.hpp"

#include <algorithm>

#include "spin/majorana.hpp"
#include "transport/branches.hpp"

namespace rabiline {

LevelQuestions::LevelQuestions(const Beamline& beamline, const Species& species, const SpinHistory& spins,
                               bool straight)
    : species_(species),
      spins_(spins),
      straight_(straight),
      quantum_(std::holds_alternative<QuantumLaw>(beamline.law)) {}

std::optional<LevelProjection> LevelQuestions::at_magnet(const Plane& plane) const {
  if (!quantum_) return std::nullopt;
  LevelProjection asked;
  asked.part = plane.part;
  asked.levels = species_.levels();
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
