#pragma once
// A deflecting magnet finds the level of each particle.
#include "transport/spin_path.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

/// A deflecting magnet asks for the level along the field, after the fields of a straight flight. `split`:
/// the weight is shared out over all levels and each is followed on; else one is drawn.
struct LevelProjection {
  int part = 0;
  double at = 0;  // [m]
  bool split = false;
  SpinPath spins;
  bool operator==(const LevelProjection&) const = default;

  static constexpr StageTraits traits{.spins = SpinEffect::set};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
  const SpinPath* path() const { return &spins; }
  bool splits() const { return split; }
};
static_assert(StageKind<LevelProjection>);

}  // namespace rabiline
