#pragma once
// A polariser or an analyser that lets spins through.
#include "transport/kernels.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

/// Spins S along the axis pass with one probability, spins against it with another one.
struct Filter {
  double axis[3] = {0, 0, 1};
  double up = 1, down = 0;
  bool quantum = false;  // the state is the level's, along the spin's image: spin 1/2
  int part = 0;
  double at = 0;  // [m]
  bool operator==(const Filter&) const = default;

  static constexpr StageTraits traits{.ends_particles = true, .spins = SpinEffect::set};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
};
static_assert(StageKind<Filter>);

/// Returns the weight that stopped [quanta].
RABILINE_KERNEL(filter, std::uint64_t(const Filter&, BatchView&))

}  // namespace rabiline
