#pragma once
// Where a flight asks for the level of a particle: at deflecting magnets, filters and detectors.
#include <optional>
#include <vector>

#include "plan/sampled_tables.hpp"
#include "plan/spin_history.hpp"
#include "transport/stage.hpp"

namespace rabiline {

/// Asks for levels along the field; the vector laws have two, S along z and against it.
class LevelQuestions {
 public:
  /// All must outlive it. `straight`: nothing in the beam turns the velocity.
  LevelQuestions(const Beamline& beamline, const Species& species, const Sections& sections,
                 const SpinHistory& spins, bool straight, SampledTables& tables);

  /// None where the level is still the one that was asked for last, or under a vector law.
  std::optional<LevelProjection> at_plane(const Plane&, const UnitVector& axis) const;
  SpinStretch at_detector(const Plane&) const;

  /// What acts on the levels of an atom since they were known last.
  void carry_levels(const Plane&, SpinPath&) const;

 private:
  /// Null where nothing drives levels before that plane.
  const DrivenLevels* transitions_before(const Plane&) const;

  const Beamline& beamline_;
  const Species& species_;
  const Sections& sections_;
  const SpinHistory& spins_;
  const bool straight_, quantum_;
  SampledTables& tables_;
};

/// The first projection behind which everything can be booked afterwards shares out the weights, where the
/// law says so; those behind it draw, as do those in front.
void split_projections(const Law&, std::vector<Stage>& chain);

}  // namespace rabiline
