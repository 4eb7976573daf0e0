// Other scans from what one flight leaves, against the same scans flown.
#include <gtest/gtest.h>

#include "apparatus.hpp"
#include "simulation/form.hpp"
#include "simulation/precision.hpp"
#include "simulation/rescan.hpp"

namespace rabiline::test::rescan_test {
namespace {

Experiment experiment_of(std::vector<Beamline> points) {
  Experiment e;
  e.points = std::move(points);
  return e;
}

struct Flown {
  Experiment experiment;
  Result result;
  std::optional<FlightRecord> record;
};
Flown fly(std::vector<Beamline> points, KeptBins bins, const RunOptions& options = {},
          const MomentsWanted& moments = {}) {
  Flown out{experiment_of(std::move(points)), {}, {}};
  const Plan plan = make_plan(out.experiment, 0, most_tree_cost, moments);
  const RunOutcome outcome = run(plan, options);
  std::string_view why;
  out.record = record_of(out.experiment, plan, outcome, bins, why);
  out.result = finish(out.experiment, plan, outcome.sums);
  return out;
}
Result rescanned(const Flown& flown, std::vector<Beamline> points) {
  return rescan(flown.experiment, *flown.record, experiment_of(std::move(points)), default_memory,
                best_isa());
}

void expect_close(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], tolerance);
}
void expect_same_scan(const Result& a, const Result& b) {
  const double emitted = a.emitted[0];
  expect_close(a.detectors[0].detected, b.detectors[0].detected, 1e-9);
  expect_close(a.detectors[0].detected_errors, b.detectors[0].detected_errors, 1e-9);
  expect_close(a.detectors[0].detected_covariance, b.detectors[0].detected_covariance, 1e-12);
  expect_close(a.detectors[0].levels, b.detectors[0].levels, 1e-8);
  ASSERT_EQ(a.fates.size(), b.fates.size());
  for (std::size_t f = 0; f < a.fates.size(); ++f) {
    expect_close(a.fates[f].particles, b.fates[f].particles, 1e-9 * emitted);
    expect_close(a.fates[f].by_level, b.fates[f].by_level, 1e-9 * emitted);
  }
}

std::vector<Beamline> narrower(const Apparatus& apparatus) {
  std::vector<Beamline> out;
  for (int i = 0; i < 7; ++i) out.push_back(apparatus.at(apparatus.resonance() * (1 + 3e-4 * (i - 3))));
  return out;
}
std::vector<Beamline> with_bins(std::vector<Beamline> points, Bins bins) {
  for (Beamline& b : points) std::get<Detector>(b.parts.back().part).bins = bins;
  return points;
}

TEST(Rescan, GivesTotalsAndFatesOfAScanThatWasNotFlown) {
  for (const bool aimed : {false, true}) {
    Apparatus apparatus;
    apparatus.bins = {3, 4};
    apparatus.efficiency = 2.0 / 3;
    apparatus.aimed = aimed;
    const Flown flown = fly(apparatus.scan(9), KeptBins::totals);
    ASSERT_TRUE(flown.record);
    expect_same_scan(rescanned(flown, narrower(apparatus)),
                     run_points(with_bins(narrower(apparatus), {1, 1})));
  }
}
TEST(Rescan, GivesEveryBinWhereTheyAreKept) {
  Apparatus apparatus;
  apparatus.bins = {3, 4};
  const Flown flown = fly(apparatus.scan(9), KeptBins::images);
  const Result scan = rescanned(flown, narrower(apparatus)), again = run_points(narrower(apparatus));
  expect_same_scan(scan, again);
  expect_close(scan.detectors[0].counts, again.detectors[0].counts, 1e-9 * again.emitted[0]);
  expect_close(scan.detectors[0].counts_errors, again.detectors[0].counts_errors, 1e-6);
}
TEST(Rescan, OfTheSamePointsHasTheSameBits) {
  Apparatus apparatus;
  apparatus.species = point_of_spin(3);
  apparatus.tallied = true;
  const Flown flown = fly(apparatus.scan(9), KeptBins::images);
  const Result again = rescanned(flown, apparatus.scan(9));
  EXPECT_EQ(flown.result.detectors[0].counts, again.detectors[0].counts);
  EXPECT_EQ(flown.result.detectors[0].detected_covariance, again.detectors[0].detected_covariance);
  EXPECT_EQ(flown.result.detectors[0].levels_errors, again.detectors[0].levels_errors);
  EXPECT_EQ(flown.result.monitors[0].passed_covariance, again.monitors[0].passed_covariance);
  for (std::size_t i = 0; i < again.tallies.size(); ++i) {
    EXPECT_EQ(flown.result.tallies[i].counts_errors, again.tallies[i].counts_errors);
    EXPECT_EQ(flown.result.tallies[i].axes.back().mean_errors, again.tallies[i].axes.back().mean_errors);
  }
  for (std::size_t f = 0; f < again.fates.size(); ++f)
    EXPECT_EQ(flown.result.fates[f].quanta_low, again.fates[f].quanta_low);
}
/// Monitors count a total, as detectors do; tallies are bins.
TEST(Rescan, KeepsWhatMonitorsCountAndTalliesWithTheBins) {
  Apparatus apparatus;
  apparatus.tallied = true;
  for (const KeptBins bins : {KeptBins::totals, KeptBins::images}) {
    const Flown flown = fly(apparatus.scan(9), bins);
    ASSERT_TRUE(flown.record);
    const Result scan = rescanned(flown, narrower(apparatus)), again = run_points(narrower(apparatus));
    expect_same_scan(scan, again);
    expect_close(scan.monitors[0].passed, again.monitors[0].passed, 1e-9);
    expect_close(scan.monitors[0].passed_errors, again.monitors[0].passed_errors, 1e-9);
    expect_close(scan.monitors[0].passed_covariance, again.monitors[0].passed_covariance, 1e-12);
    ASSERT_EQ(scan.tallies.size(), bins == KeptBins::images ? 3U : 0U);
    for (std::size_t i = 0; i < scan.tallies.size(); ++i) {
      expect_close(scan.tallies[i].counts, again.tallies[i].counts, 1e-9 * again.emitted[0]);
      for (std::size_t axis = 0; axis < scan.tallies[i].axes.size(); ++axis)
        expect_close(scan.tallies[i].axes[axis].mean, again.tallies[i].axes[axis].mean,
                     1e-9 * scan.tallies[i].axes[axis].edges.back());
    }
  }
}
TEST(Rescan, CanBeScannedAgain) {
  const Apparatus apparatus;
  const Flown flown = fly(apparatus.scan(9), KeptBins::totals);
  Flown second{experiment_of(narrower(apparatus)), rescanned(flown, narrower(apparatus)), {}};
  second.record = second.result.flight;
  EXPECT_EQ(rescanned(second, apparatus.scan(9)).detectors[0].counts, flown.result.detectors[0].counts);
}

TEST(Rescan, FliesStragglersAgain) {
  const Apparatus apparatus;
  std::vector<SlownessCells> cells = fly(apparatus.scan(9), KeptBins::totals).record->cells;
  // Few particles are slower than 600 m/s.
  const double range = 1 / 600.0 - cells[0].first;
  cells[0].count = static_cast<int>(std::ceil(range / cells[0].width));
  cells[0].width = range / cells[0].count;
  const Flown flown = fly(apparatus.scan(9), KeptBins::totals, {}, {true, &cells});
  EXPECT_NEAR(static_cast<double>(flown.record->stragglers.size()), 13, 12);
  Result scan = rescanned(flown, narrower(apparatus)), again = run_points(narrower(apparatus));
  std::vector<double>&a = scan.detectors[0].detected_covariance, &b = again.detectors[0].detected_covariance;
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 0.01 * b[0]);
  a = b;
  expect_close(scan.detectors[0].detected_errors, again.detectors[0].detected_errors,
               5e-3 * again.detectors[0].detected_errors[0]);
  scan.detectors[0].detected_errors = again.detectors[0].detected_errors;
  expect_same_scan(scan, again);
}

TEST(Rescan, OfAFlightThatWasStoppedAndWentOnIsTheSame) {
  Apparatus apparatus;
  apparatus.particles = 200000;
  const auto points = apparatus.scan(9);
  const Flown whole = fly(points, KeptBins::totals);
  std::optional<Snapshot> snapshot;
  RunOptions options;
  std::atomic<bool> stop = true;
  options.stop = &stop;
  options.snapshot = [&](const Snapshot& s) { snapshot = s; };
  run(make_plan(experiment_of(points)), options);
  ASSERT_TRUE(snapshot);
  RunOptions rest;
  rest.start = &*snapshot;
  const Flown resumed = fly(points, KeptBins::totals, rest);
  EXPECT_EQ(whole.record->stragglers, resumed.record->stragglers);
  EXPECT_EQ(whole.record->sums, resumed.record->sums);
}

void expect_refused(const Flown& flown, std::vector<Beamline> points, const std::string& reason) {
  try {
    rescanned(flown, std::move(points));
    ADD_FAILURE() << "not refused: " << reason;
  } catch (const std::invalid_argument& refusal) {
    EXPECT_NE(std::string(refusal.what()).find(reason), std::string::npos) << refusal.what();
  }
}
TEST(Rescan, RefusesWhatDoesNotFollowFromTheFlight) {
  const Apparatus apparatus;
  const Flown flown = fly(apparatus.scan(9), KeptBins::totals);
  const auto changed = [&](auto change) {
    std::vector<Beamline> points = narrower(apparatus);
    for (Beamline& b : points) change(b);
    return points;
  };
  expect_refused(flown,
                 changed([](Beamline& b) { std::get<RotatingField>(b.parts[2].part).amplitude *= 20; }),
                 "turn faster");
  expect_refused(flown, changed([](Beamline& b) {
                   b.source.speed = GaussianSpeed{801, 60};
                 }),
                 "more than how");
  expect_refused(flown,
                 changed([](Beamline& b) { std::get<GradientMagnet>(b.parts[0].part).gradient *= 1.01; }),
                 "more than how");
  expect_refused(flown, changed([](Beamline& b) { b.parts.back().placement.at += 1e-3; }), "more than how");
  expect_refused(flown, changed([](Beamline& b) { b.law = QuantumLaw{Outcomes::sample}; }), "more than how");
}

}  // namespace
}  // namespace rabiline::test::rescan_test
