#pragma once
// The screen of a detector.
#include <memory>

#include "transport/kernels.hpp"
#include "transport/stage_concept.hpp"
#include "transport/sum_layout.hpp"

namespace rabiline {

/// What hits a screen is caught and histogrammed.
struct Score {
  Screen screen;
  bool operator==(const Score&) const = default;

  static constexpr StageTraits traits{.ends_particles = true};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
  int catches() const;
  double counted_share() const { return screen.efficiency; }
  std::unique_ptr<PathTally> tally_paths() const;
};
static_assert(StageKind<Score>);

ScreenSums sums_of(const Screen&);
/// Names the fates and the tally of a screen whose sums begin at `at`.
void list_screen(const Screen&, std::size_t at, SumSink&);
/// Adds a caught weight to the sums of a screen.
void add_caught(const ScreenSums&, Sum* sums, std::uint64_t bin, std::uint64_t weight,
                std::uint64_t particle);

/// Bins come into scratch, ~0: not counted. What was caught weighs what was counted of it. Lists the places
/// in the batch of what was caught; there is room for eight more.
RABILINE_KERNEL(screen, Caught(const Screen&, BatchView&, std::uint64_t* list))

}  // namespace rabiline
