#pragma once
// A beam scattered by gas.
#include "parts/gas_cell.hpp"
#include "transport/kernels.hpp"
#include "transport/plane_stage.hpp"

namespace rabiline {

/// exp(-depth l/length) of each weight goes on, l the path along the length.
struct Attenuation : PlaneStage {
  double depth = 0;   // n sigma times the length along the beam
  double length = 0;  // [m] along the beam
  bool operator==(const Attenuation&) const = default;

  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
};
static_assert(StageKind<Attenuation>);
Attenuation stage_of(const GasCell&, const StageSite&);

/// Returns the weight that was scattered [quanta].
RABILINE_KERNEL(attenuate, std::uint64_t(const Attenuation&, BatchView&))

}  // namespace rabiline
