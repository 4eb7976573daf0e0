#pragma once
// A shutter that opens periodically.
#include "parts/chopper.hpp"
#include "transport/kernels.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

/// What comes while the fractional part of frequency t + lead is not less than `open` stops there.
struct Chopping {
  double open = 1;       // fraction of each period
  double frequency = 0;  // [Hz]
  double lead = 0;       // [periods] at t = 0
  int part = 0;
  double at = 0;  // [m]
  bool operator==(const Chopping&) const = default;

  static constexpr StageTraits traits{.ends_particles = true};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
};
static_assert(StageKind<Chopping>);
Chopping stage_of(const Chopper&, const StageSite&);

/// Returns the weight that stopped [quanta].
RABILINE_KERNEL(chop, std::uint64_t(const Chopping&, BatchView&))

}  // namespace rabiline
