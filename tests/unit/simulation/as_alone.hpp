#pragma once
// Scan points from moments of the slowness against the same points flown alone.
#include <gtest/gtest.h>

#include <cmath>

#include "physics/suggested.hpp"

namespace rabiline::test {

inline bool has_moments(const std::vector<PlanNode>& nodes) {
  return std::any_of(nodes.begin(), nodes.end(),
                     [](const PlanNode& node) { return node.transit != nullptr || has_moments(node.next); });
}
inline Plan plan_of(const std::vector<Beamline>& points, const MomentsWanted& wanted = {}) {
  Experiment e;
  e.points = points;
  return make_plan(e, 0, most_tree_cost, wanted);
}
inline bool has_moments(const std::vector<Beamline>& points) {
  return has_moments(plan_of(points).trees.front().next);
}

inline void expect_as_alone(const std::vector<Beamline>& scan, const MomentsWanted& wanted = {}) {
  const Plan plan = plan_of(scan, wanted);
  ASSERT_TRUE(has_moments(plan.trees.front().next));
  ASSERT_FALSE(has_moments({scan.front()}));
  Experiment e;
  e.points = scan;
  const Result all = finish(e, plan, run(plan, {}).sums);
  const DetectorResult& screen = all.detectors[0];
  const double emitted = all.emitted[0];
  for (std::size_t at = 0; at < scan.size(); ++at) {
    const Result one = run_points({scan[at]});
    const DetectorResult& alone = one.detectors[0];
    for (std::size_t b = 0; b < alone.counts.size(); ++b) {
      EXPECT_NEAR(screen.counts[at * alone.counts.size() + b], alone.counts[b], 1e-9 * emitted);
      EXPECT_NEAR(screen.counts_errors[at * alone.counts.size() + b], alone.counts_errors[b],
                  1e-6 * std::sqrt(emitted));
    }
    for (std::size_t x = 0; x < alone.counts_x.size(); ++x)
      EXPECT_NEAR(screen.counts_x_errors[at * alone.counts_x.size() + x], alone.counts_x_errors[x],
                  1e-6 * std::sqrt(emitted));
    for (std::size_t z = 0; z < alone.counts_z.size(); ++z)
      EXPECT_NEAR(screen.counts_z_errors[at * alone.counts_z.size() + z], alone.counts_z_errors[z],
                  1e-6 * std::sqrt(emitted));
    for (std::size_t level = 0; level < alone.levels.size() && alone.detected[0] > 1e-3; ++level) {
      EXPECT_NEAR(screen.levels[at * alone.levels.size() + level], alone.levels[level], 1e-8);
      EXPECT_NEAR(screen.levels_errors[at * alone.levels.size() + level], alone.levels_errors[level], 1e-7);
    }
    ASSERT_EQ(all.fates.size(), one.fates.size());
    for (std::size_t f = 0; f < one.fates.size(); ++f) {
      EXPECT_NEAR(all.fates[f].particles[at], one.fates[f].particles[0], 1e-9 * emitted);
      for (std::size_t level = 0; level < one.fates[f].by_level.size(); ++level)
        EXPECT_NEAR(all.fates[f].by_level[at * one.fates[f].by_level.size() + level],
                    one.fates[f].by_level[level], 1e-9 * emitted);
    }
  }
}

/// For any threads, batches and instruction sets.
inline void expect_same_bits(const std::vector<Beamline>& scan) {
  Experiment e;
  e.points = scan;
  const Plan plan = make_plan(e);
  ASSERT_TRUE(has_moments(plan.trees.front().next));
  const DetectorResult one = finish(e, plan, run(plan, {}).sums).detectors[0];
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
    if (!supported(isa)) continue;
    RunOptions options;
    options.isa = isa;
    options.threads = 3;
    options.batch = isa == Isa::baseline ? 512 : 40;
    const DetectorResult other = finish(e, plan, run(plan, options).sums).detectors[0];
    EXPECT_EQ(one.counts, other.counts);
    EXPECT_EQ(one.counts_errors, other.counts_errors);
    EXPECT_EQ(one.detected_covariance, other.detected_covariance);
    EXPECT_EQ(one.levels_errors, other.levels_errors);
  }
}

}  // namespace rabiline::test
