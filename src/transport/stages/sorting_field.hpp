#pragma once
// A field that differs from place to place, and sorts levels.
#include <optional>

#include "core/unit_vector.hpp"
#include "transport/stages/turning_region.hpp"
#include "transport/stages/wall_stop.hpp"

namespace rabiline {

/// Each particle stays in its level along the field and is pushed by mu grad |B|. What does not come through
/// is stopped; what has met the wall of another part, or left a map, flies on with its mark.
struct SortingField {
  TurningRegion region;                     // whose coupling follows levels; without edges and sights
  int part = 0;                             // whose field it is
  std::optional<UnitVector> axis_behind{};  // of levels of one moment, where they follow the field to another
  bool operator==(const SortingField&) const = default;

  static constexpr StageTraits traits{
      .ends_particles = true, .spins = SpinEffect::carried, .levels = LevelEffect::separated};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
  static bool marks_walls() { return true; }
  /// What must stand behind it.
  std::vector<WallStop> stops_behind() const;
};
static_assert(StageKind<SortingField>);

}  // namespace rabiline
