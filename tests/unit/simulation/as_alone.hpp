#pragma once
// Scan points from moments of the slowness against the same points flown alone.
#include <gtest/gtest.h>

#include <cmath>
#include <span>

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

/// Point `at` of a list over all points, and the same of a point that was flown alone.
inline void expect_near_at(std::size_t at, const std::vector<double>& all, const std::vector<double>& alone,
                           double tolerance) {
  for (std::size_t i = 0; i < alone.size(); ++i)
    EXPECT_NEAR(all[at * alone.size() + i], alone[i], tolerance) << "number " << i << " of point " << at;
}

inline void expect_detector_as_alone(std::size_t at, const DetectorResult& all, const DetectorResult& alone,
                                     double emitted) {
  const double error = 1e-6 * std::sqrt(emitted);
  expect_near_at(at, all.counts, alone.counts, 1e-9 * emitted);
  expect_near_at(at, all.counts_errors, alone.counts_errors, error);
  expect_near_at(at, all.counts_x_errors, alone.counts_x_errors, error);
  expect_near_at(at, all.counts_z_errors, alone.counts_z_errors, error);
  if (alone.detected[0] <= 1e-3) return;
  expect_near_at(at, all.levels, alone.levels, 1e-8);
  expect_near_at(at, all.levels_errors, alone.levels_errors, 1e-7);
}

/// Errors of weights that differ are exact by moments, and else from how groups of particles scatter.
inline void expect_monitor_as_alone(std::size_t at, const MonitorResult& all, const MonitorResult& alone,
                                    bool alike) {
  expect_near_at(at, all.passed, alone.passed, 1e-9);
  for (std::size_t i = 0; i < alone.passed.size(); ++i)
    EXPECT_NEAR(all.passed_errors[at * alone.passed.size() + i], alone.passed_errors[i],
                alike ? 1e-9 : 0.3 * alone.passed_errors[i]);
}

inline void expect_tally_as_alone(std::size_t at, const TallyResult& all, const TallyResult& alone,
                                  double emitted) {
  SCOPED_TRACE(all.part + " " + all.name);
  const double error = 1e-6 * std::sqrt(emitted);
  expect_near_at(at, all.counts, alone.counts, 1e-9 * emitted);
  expect_near_at(at, all.counts_errors, alone.counts_errors, error);
  expect_near_at(at, all.outside, alone.outside, 1e-9 * emitted);
  expect_near_at(at, all.outside_errors, alone.outside_errors, error);
  const std::size_t bins = alone.counts.size() / alone.planes;
  for (std::size_t axis = 0; axis < alone.axes.size(); ++axis) {
    const TallyAxisResult &own = all.axes[axis], &other = alone.axes[axis];
    const double range = own.edges.back() - own.edges.front();
    for (std::size_t plane = 0; plane < other.mean.size(); ++plane) {
      double inside = 0;
      for (std::size_t bin = 0; bin < bins; ++bin) inside += alone.counts[plane * bins + bin];
      if (inside < 1e-3 * emitted) continue;
      const std::size_t i = at * other.mean.size() + plane;
      EXPECT_NEAR(own.mean[i], other.mean[plane], 1e-9 * range);
      EXPECT_NEAR(own.mean_errors[i], other.mean_errors[plane], 1e-8 * range);
      EXPECT_NEAR(own.deviation[i], other.deviation[plane], 1e-7 * range);
      EXPECT_NEAR(own.deviation_errors[i], other.deviation_errors[plane], 1e-7 * range);
    }
  }
}

inline RunOptions quickest() {
  RunOptions options;
  options.isa = best_isa();
  return options;
}
inline Result flown(const std::vector<Beamline>& scan, const Plan& plan,
                    const RunOptions& options = quickest()) {
  Experiment e;
  e.points = scan;
  return finish(e, plan, run(plan, options).sums);
}

/// Every so manieth point.
inline void expect_points_as_alone(const std::vector<Beamline>& scan, const Plan& plan,
                                   std::size_t every = 1) {
  const Result all = flown(scan, plan);
  const double emitted = all.emitted[0];
  for (std::size_t at = 0; at < scan.size(); at += every) {
    const Result one = run_points({scan[at]});
    expect_detector_as_alone(at, all.detectors[0], one.detectors[0], emitted);
    for (std::size_t i = 0; i < one.monitors.size(); ++i)
      expect_monitor_as_alone(at, all.monitors[i], one.monitors[i],
                              one.emitted[0] == static_cast<double>(one.particles));
    for (std::size_t i = 0; i < one.tallies.size(); ++i)
      expect_tally_as_alone(at, all.tallies[i], one.tallies[i], emitted);
    ASSERT_EQ(all.fates.size(), one.fates.size());
    for (std::size_t f = 0; f < one.fates.size(); ++f) {
      expect_near_at(at, all.fates[f].particles, one.fates[f].particles, 1e-9 * emitted);
      expect_near_at(at, all.fates[f].by_level, one.fates[f].by_level, 1e-9 * emitted);
    }
  }
}

inline void expect_as_alone(const std::vector<Beamline>& scan, const MomentsWanted& wanted = {}) {
  const Plan plan = plan_of(scan, wanted);
  ASSERT_TRUE(has_moments(plan.trees.front().next));
  ASSERT_FALSE(has_moments({scan.front()}));
  expect_points_as_alone(scan, plan);
}

/// A covariance between points that is known exactly, and the same from groups of particles, perhaps of more
/// points.
inline void expect_as_groups_scatter(std::span<const double> exact, std::span<const double> groups) {
  const auto points = static_cast<std::size_t>(std::sqrt(static_cast<double>(exact.size()))),
             all = static_cast<std::size_t>(std::sqrt(static_cast<double>(groups.size())));
  for (std::size_t i = 0; i < points; ++i)
    for (std::size_t j = 0; j < points; ++j) {
      const double own = exact[i * points + j], variances = exact[i * points + i] * exact[j * points + j];
      // Of normally distributed numbers: Var(C_ij) = (C_ij^2 + C_ii C_jj)/255.
      EXPECT_NEAR(own, groups[i * all + j], 4 * std::sqrt((own * own + variances) / 255));
    }
}

inline void expect_same_numbers(const Result& one, const Result& other) {
  EXPECT_EQ(one.detectors[0].counts, other.detectors[0].counts);
  EXPECT_EQ(one.detectors[0].counts_errors, other.detectors[0].counts_errors);
  EXPECT_EQ(one.detectors[0].detected_covariance, other.detectors[0].detected_covariance);
  EXPECT_EQ(one.detectors[0].levels_errors, other.detectors[0].levels_errors);
  for (std::size_t i = 0; i < one.monitors.size(); ++i) {
    EXPECT_EQ(one.monitors[i].passed_errors, other.monitors[i].passed_errors);
    EXPECT_EQ(one.monitors[i].passed_covariance, other.monitors[i].passed_covariance);
  }
  for (std::size_t i = 0; i < one.tallies.size(); ++i) {
    EXPECT_EQ(one.tallies[i].counts, other.tallies[i].counts);
    EXPECT_EQ(one.tallies[i].counts_errors, other.tallies[i].counts_errors);
    EXPECT_EQ(one.tallies[i].outside, other.tallies[i].outside);
    for (std::size_t a = 0; a < one.tallies[i].axes.size(); ++a) {
      EXPECT_EQ(one.tallies[i].axes[a].mean, other.tallies[i].axes[a].mean);
      EXPECT_EQ(one.tallies[i].axes[a].deviation_errors, other.tallies[i].axes[a].deviation_errors);
    }
  }
}

/// For any threads, batches and instruction sets.
inline void expect_same_bits(const std::vector<Beamline>& scan, const Plan& plan) {
  const Result one = flown(scan, plan);
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
    if (!supported(isa)) continue;
    RunOptions options;
    options.isa = isa;
    options.threads = 3;
    options.batch = isa == Isa::baseline ? 512 : 40;
    expect_same_numbers(one, flown(scan, plan, options));
  }
}
inline void expect_same_bits(const std::vector<Beamline>& scan) {
  const Plan plan = plan_of(scan);
  ASSERT_TRUE(has_moments(plan.trees.front().next));
  expect_same_bits(scan, plan);
}

}  // namespace rabiline::test
