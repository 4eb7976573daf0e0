#pragma once
// A filter that lets levels of an atom through, behind a projection that has found them.
#include "transport/kernels.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

/// Each level passes with a probability of its own, which multiplies the weight of what is in it.
struct LevelFilter {
  double passes[most_levels] = {};  // by the level's number
  int named = 0;                    // how many levels it names
  int part = 0;
  double at = 0;  // [m]
  bool operator==(const LevelFilter&) const = default;

  static constexpr StageTraits traits{.ends_particles = true};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
};
static_assert(StageKind<LevelFilter>);

}  // namespace rabiline
