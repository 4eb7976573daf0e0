#pragma once
// An opening in a plate, or the end of a channel.
#include <limits>
#include <vector>

#include "transport/kernels.hpp"
#include "transport/stage_concept.hpp"
#include "transport/wall_row.hpp"

namespace rabiline {

/// What misses the opening, or on its parabola met the wall of the channel that ends in it, stops at that
/// part: but for what has met another wall before.
struct Passage {
  Aperture aperture;
  int part = 0;
  double begin =
      std::numeric_limits<double>::infinity();  // [m] of the channel; an opening in a plate has none
  std::vector<Aperture> rivals{};               // other walls between there and the opening
  bool operator==(const Passage&) const = default;

  static constexpr StageTraits traits{.ends_particles = true};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
  /// Where its wall begins, and the same wall up to a place before its end.
  double from() const { return begin; }
  double to() const { return aperture.y; }
  Passage until(double y) const;
};
static_assert(StageKind<Passage>);

/// Returns the weight that stopped [quanta].
RABILINE_KERNEL(pass, std::uint64_t(const Passage&, BatchView&))
/// Of a wall that has rivals.
RABILINE_KERNEL(pass_unless_met, std::uint64_t(const Passage&, const WallRow& rivals, BatchView&))

}  // namespace rabiline
