#pragma once
// An opening in a plate, or the end of a channel.
#include <limits>

#include "transport/kernels.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

/// What misses the opening, or on its parabola met the wall of the channel that ends in it, stops at that
/// part.
struct Passage {
  Aperture aperture;
  int part = 0;
  double begin =
      std::numeric_limits<double>::infinity();  // [m] of the channel; an opening in a plate has none
  bool operator==(const Passage&) const = default;

  static constexpr StageTraits traits{.ends_particles = true};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
};
static_assert(StageKind<Passage>);

/// Returns the weight that stopped [quanta].
RABILINE_KERNEL(pass, std::uint64_t(const Passage&, BatchView&))

}  // namespace rabiline
