#pragma once
// Spins brought up to date on a straight flight.
#include "transport/spin_zones.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

/// Carries spins through the fields of a straight flight, for what comes next to ask about them.
struct Precession {
  SpinZones zones;
  bool operator==(const Precession&) const = default;

  static constexpr StageTraits traits{.spins = SpinEffect::carried};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
};
static_assert(StageKind<Precession>);

/// Carries the spins of what flies through the zones.
RABILINE_KERNEL(precess, void(const SpinZone*, int zone_count, const RandomKey&, BatchView&))

}  // namespace rabiline
