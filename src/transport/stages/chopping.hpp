#pragma once
// A shutter that opens periodically.
#include "parts/chopper.hpp"
#include "transport/kernels.hpp"
#include "transport/plane_stage.hpp"

namespace rabiline {

/// What comes while the fractional part of frequency t + lead is not less than `open` stops there.
struct Chopping : PlaneStage {
  double open = 1;       // fraction of each period
  double frequency = 0;  // [Hz]
  double lead = 0;       // [periods] at t = 0
  bool operator==(const Chopping&) const = default;

  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
};
static_assert(StageKind<Chopping>);
Chopping stage_of(const Chopper&, const StageSite&);

/// Returns the weight that stopped [quanta].
RABILINE_KERNEL(chop, std::uint64_t(const Chopping&, BatchView&))

}  // namespace rabiline
