#pragma once
// The end of the beamline.
#include "transport/stage_concept.hpp"

namespace rabiline {

/// What still flies after the last part has passed.
struct Exit {
  bool operator==(const Exit&) const = default;

  static constexpr StageTraits traits{.ends_particles = true};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
};
static_assert(StageKind<Exit>);

}  // namespace rabiline
