#pragma once
// An opening in a plate or a wall.
#include "transport/kernels.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

/// What misses the opening stops at that part.
struct Passage {
  Aperture aperture;
  int part = 0;
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
RABILINE_KERNEL(pass, std::uint64_t(const Aperture&, BatchView&))

}  // namespace rabiline
