#pragma once
// A band of speeds that a velocity selector passes.
#include "parts/velocity_selector.hpp"
#include "transport/kernels.hpp"
#include "transport/plane_stage.hpp"

namespace rabiline {

/// The share of each weight that goes on is a triangle in 1/v, v along the beam.
struct VelocitySelection : PlaneStage {
  double speed = 0;         // [m/s] the nominal one
  double resolution = 0;    // full width at half maximum of 1/v, relative
  double transmission = 1;  // of the nominal speed
  bool operator==(const VelocitySelection&) const = default;

  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
};
static_assert(StageKind<VelocitySelection>);
VelocitySelection stage_of(const VelocitySelector&, const StageSite&);

/// Returns the weight that stopped [quanta].
RABILINE_KERNEL(select_velocities, std::uint64_t(const VelocitySelection&, BatchView&))

}  // namespace rabiline
