#pragma once
// A beam scattered by gas.
#include <vector>

#include "parts/gas_cell.hpp"
#include "transport/kernels.hpp"
#include "transport/plane_stage.hpp"
#include "transport/wall_row.hpp"

namespace rabiline {

/// exp(-depth l/length) of each weight goes on, l the path along the length; of what meets a wall, up to
/// there.
struct Attenuation : PlaneStage {
  double depth = 0;               // n sigma times the length along the beam
  double length = 0;              // [m] along the beam
  std::vector<Aperture> walls{};  // around all of it
  bool operator==(const Attenuation&) const = default;

  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
  /// What of it lies between two places; all of it has the same bits.
  Attenuation between(double from, double to) const;
};
static_assert(StageKind<Attenuation>);
Attenuation stage_of(const GasCell&, const StageSite&);

/// Returns the weight that was scattered [quanta].
RABILINE_KERNEL(attenuate, std::uint64_t(const Attenuation&, const WallRow&, BatchView&))

}  // namespace rabiline
