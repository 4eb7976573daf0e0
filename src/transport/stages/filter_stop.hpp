#pragma once
// Where a filter stops what it does not let pass, behind a projection that has asked the filter.
#include "transport/stage_concept.hpp"

namespace rabiline {

/// Paths of one outcome of the projection end here; the weights of the others are as they were
/// (SpinPath::filters). So what stands behind is the same whatever the filter lets pass.
struct FilterStop {
  int part = 0;
  double at = 0;  // [m]
  int outcome = 0;
  bool operator==(const FilterStop&) const = default;

  static constexpr StageTraits traits{.ends_particles = true};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
};
static_assert(StageKind<FilterStop>);

}  // namespace rabiline
