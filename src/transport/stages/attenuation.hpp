#pragma once
// A beam scattered by gas.
#include "parts/gas_cell.hpp"
#include "transport/kernels.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

/// exp(-depth l/length) of each weight goes on, l the straight path along the length.
struct Attenuation {
  double depth = 0;  // n sigma times the length along the beam
  int part = 0;
  double at = 0;  // [m]
  bool operator==(const Attenuation&) const = default;

  static constexpr StageTraits traits{.ends_particles = true};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
};
static_assert(StageKind<Attenuation>);
Attenuation stage_of(const GasCell&, const StageSite&);

/// Returns the weight that was scattered [quanta].
RABILINE_KERNEL(attenuate, std::uint64_t(const Attenuation&, BatchView&))

}  // namespace rabiline
