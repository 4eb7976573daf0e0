// Scans in slabs of points, against the same scans in one piece.
#include "simulation/form.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "apparatus.hpp"
#include "simulation/append.hpp"
#include "simulation/form_flight.hpp"
#include "simulation/rescan.hpp"
#include "simulation/run.hpp"

namespace rabiline::test::form_test {
namespace {

constexpr int many = 4200;  // points: more than stand in one slab, where memory is short
constexpr std::uint64_t no_memory = 1, all_memory = std::uint64_t{1} << 40;

Experiment scan_of(const Apparatus& apparatus) {
  Experiment e;
  const double resonance = apparatus.resonance();
  e.points = {many, [first = apparatus.at(resonance), resonance](std::size_t p) {
                Beamline b = first;
                std::get<RotatingField>(b.parts[2].part).frequency =
                    resonance * (1 + 1e-6 * (static_cast<double>(p) - many / 2));
                return b;
              }};
  return e;
}
struct Flown {
  Form form;
  RunOutcome outcome;
  Result result;
};
Flown fly(const Experiment& e, std::uint64_t max_memory) {
  Flown out{form_of(e, {true}, {max_memory}), {}, {}};
  const FormFlight flight(out.form, e, 2);
  out.outcome = flight.run({});
  out.result = flight.finish(out.outcome, best_isa(), {});
  return out;
}

void expect_same(const Result& a, const Result& b) {
  EXPECT_EQ(a.emitted_quanta_low, b.emitted_quanta_low);
  EXPECT_EQ(a.laws.size(), b.laws.size());
  ASSERT_EQ(a.detectors.size(), b.detectors.size());
  for (std::size_t i = 0; i < a.detectors.size(); ++i)
    for (const auto column :
         {&DetectorResult::counts, &DetectorResult::counts_errors, &DetectorResult::detected,
          &DetectorResult::detected_errors, &DetectorResult::levels, &DetectorResult::levels_errors,
          &DetectorResult::detected_of_all_errors})
      EXPECT_EQ(a.detectors[i].*column, b.detectors[i].*column);
  ASSERT_EQ(a.monitors.size(), b.monitors.size());
  for (std::size_t i = 0; i < a.monitors.size(); ++i)
    EXPECT_EQ(a.monitors[i].passed_errors, b.monitors[i].passed_errors);
  ASSERT_EQ(a.tallies.size(), b.tallies.size());
  for (std::size_t i = 0; i < a.tallies.size(); ++i) {
    EXPECT_EQ(a.tallies[i].counts, b.tallies[i].counts);
    EXPECT_EQ(a.tallies[i].outside_errors, b.tallies[i].outside_errors);
    for (std::size_t k = 0; k < a.tallies[i].axes.size(); ++k)
      EXPECT_EQ(a.tallies[i].axes[k].deviation, b.tallies[i].axes[k].deviation);
  }
  ASSERT_EQ(a.fates.size(), b.fates.size());
  for (std::size_t i = 0; i < a.fates.size(); ++i) {
    EXPECT_EQ(a.fates[i].quanta_low, b.fates[i].quanta_low);
    EXPECT_EQ(a.fates[i].by_level, b.fates[i].by_level);
  }
}

TEST(Slabs, ChangeNoBitOfAResult) {
  for (const bool aimed : {false, true}) {
    Apparatus apparatus;
    apparatus.particles = 600;
    apparatus.bins = {2, 1};
    apparatus.aimed = aimed;
    apparatus.tallied = !aimed;
    const Experiment e = scan_of(apparatus);
    const Flown whole = fly(e, all_memory), slabs = fly(e, no_memory);
    EXPECT_EQ(whole.form.slabs, 1U);
    EXPECT_EQ(slabs.form.slabs, 2U);
    EXPECT_LT(slabs.form.plan.sums, whole.form.plan.sums / 10);
    EXPECT_EQ(slabs.result.detectors[0].detected.size(), std::size_t{many});
    EXPECT_NE(slabs.result.detectors[0].detected.front(), slabs.result.detectors[0].detected[many / 2]);
    expect_same(whole.result, slabs.result);
  }
}

/// With points that `change(number, beamline)` has changed.
template <class Change>
Experiment changed(const Experiment& scan, Change change) {
  Experiment e = scan;
  e.points = {many, [points = scan.points, change](std::size_t p) {
                Beamline b = points[p];
                change(p, b);
                return b;
              }};
  return e;
}

/// The last point steers otherwise than the others.
Experiment scan_of_flights(const Apparatus& apparatus) {
  return changed(scan_of(apparatus), [](std::size_t p, Beamline& b) {
    if (p == many - 1) std::get<GradientMagnet>(b.parts.front().part).gradient *= 1.01;
  });
}

TEST(Slabs, FlyByThemselvesWhereOnePointDoesNotFollow) {
  const Form form = form_of(scan_of_flights({}), {}, {no_memory});
  EXPECT_TRUE(form.flies_in_slabs());
  EXPECT_EQ(form.flown.points.size(), std::size_t{many / 2});
}

TEST(Slabs, ThatFlyChangeNoBitOfAResult) {
  for (const bool aimed : {false, true}) {
    Apparatus apparatus;
    apparatus.particles = 24;
    apparatus.bins = {2, 1};
    apparatus.aimed = aimed;
    apparatus.tallied = !aimed;
    Experiment e = scan_of_flights(apparatus);
    e.particles = aimed ? ScanParticles::independent : ScanParticles::shared;
    const Flown whole = fly(e, all_memory), slabs = fly(e, no_memory);
    EXPECT_EQ(whole.form.slabs, 1U);
    EXPECT_EQ(slabs.form.slabs, 2U);
    expect_same(whole.result, slabs.result);
  }
}

TEST(Slabs, ThatFlyGoOnFromEverySnapshotOfTheRun) {
  Apparatus apparatus;
  apparatus.particles = 64;
  const Experiment e = scan_of_flights(apparatus);
  const Flown whole = fly(e, no_memory);
  const FormFlight flight(whole.form, e, 2);
  std::vector<Snapshot> told;
  RunOptions options;
  options.grain = 1e-5;
  options.snapshot_seconds = 0;
  options.snapshot = [&](Snapshot snapshot) { told.push_back(std::move(snapshot)); };
  options.progress = [](const Progress& now) { EXPECT_LE(now.done, 1); };
  EXPECT_TRUE(flight.run(options).finished);
  ASSERT_GT(told.size(), 2U);
  EXPECT_TRUE(told.back().complete);
  EXPECT_EQ(std::ranges::count(told, true, &Snapshot::complete), 1);
  for (const std::size_t k : {std::size_t{0}, told.size() / 2, told.size() - 2, told.size() - 1}) {
    ASSERT_TRUE(flight.fits(told[k]));
    RunOptions again;
    again.start = &told[k];
    expect_same(flight.finish(flight.run(again), best_isa(), {}), whole.result);
  }
  Snapshot other = told.front();
  other.sums.size += 1;
  EXPECT_FALSE(flight.fits(other));
}

TEST(Slabs, DoNotFlyWhereTheirDetectorsWouldHaveOtherBins) {
  const Experiment e = changed(scan_of_flights({}), [](std::size_t p, Beamline& b) {
    if (p == 1) std::get<Detector>(b.parts.back().part).face = Rectangle{5e-3, 0.6e-3};
  });
  EXPECT_EQ(form_of(e, {}, {no_memory}).slabs, 1U);
  EXPECT_THROW(form_of(e, {}, {no_memory, 1000}), std::invalid_argument);
}

TEST(Slabs, DoNotFlyWhereTheirResultsWouldListOtherThings) {
  const auto with = [](auto change) {
    return changed(scan_of_flights({}), [change](std::size_t p, Beamline& b) {
      if (p >= many / 2) change(b);
    });
  };
  EXPECT_EQ(form_of(with([](Beamline& b) { b.law = ClassicalLaw{}; }), {}, {no_memory}).slabs, 1U);
  EXPECT_EQ(form_of(with([](Beamline& b) { b.parts.erase(b.parts.begin()); }), {}, {no_memory}).slabs, 1U);
  EXPECT_EQ(form_of(with([](Beamline& b) {
                      b.species = {{point_of_spin(2), 1}};
                    }),
                    {}, {no_memory})
                .slabs,
            1U);
  // A part of what hits a detector is a fate only where it does not count all.
  const Experiment e = with([](Beamline& b) { std::get<Detector>(b.parts.back().part).efficiency = 0.5; });
  const Form form = form_of(e, {}, {no_memory});
  EXPECT_TRUE(form.flies_in_slabs());
  EXPECT_THROW(FormFlight(form, e, 2), std::invalid_argument);
}

TEST(Slabs, AreGivenInTheirOrderAndLeaveTheTotals) {
  Apparatus apparatus;
  apparatus.particles = 300;
  apparatus.tallied = true;
  const Experiment e = scan_of(apparatus);
  const Flown whole = fly(e, no_memory);
  Result given;
  std::size_t slabs = 0;
  const Result totals = finish(whole.form, e, whole.outcome.sums, whole.outcome.stragglers, 0, best_isa(), 2,
                               [&](Result& points) {
                                 ++slabs;
                                 append(Result(points), given);
                                 keep_totals(points);
                               });
  EXPECT_EQ(slabs, 2U);
  expect_same(given, whole.result);
  EXPECT_EQ(totals.emitted, whole.result.emitted);
  EXPECT_EQ(totals.detectors[0].detected, whole.result.detectors[0].detected);
  EXPECT_EQ(totals.detectors[0].detected_errors, whole.result.detectors[0].detected_errors);
  EXPECT_TRUE(totals.detectors[0].counts.empty() && totals.tallies[0].counts.empty());
  EXPECT_TRUE(totals.fates[0].particles.empty());
}

/// As no particle is outside of cells that follow from the speeds, they are narrowed.
TEST(Slabs, OfARescanShareTheStragglersOfItsFlight) {
  Apparatus apparatus;
  apparatus.particles = 600;
  Experiment one;
  one.points = {apparatus.at(apparatus.resonance())};
  std::vector<SlownessCells> cells;
  const Experiment scan = scan_of(apparatus);
  each_transit(form_of(scan, {true}, {no_memory}).plan.trees.front().next,
               [&](const PlanNode& node) { cells.push_back(node.transit->cells()); });
  ASSERT_EQ(cells.size(), 1U);
  cells[0].count = static_cast<int>((1 / 700.0 - cells[0].first) / cells[0].width);
  const Plan plan = make_plan(one, 0, most_tree_cost, {true, &cells});
  const RunOutcome outcome = run(plan, {});
  ASSERT_GT(outcome.stragglers.size(), 5U);
  std::string_view why;
  const std::optional<FlightRecord> record = record_of(one, plan, outcome, KeptBins::images, why);
  ASSERT_TRUE(record);
  const Result whole = rescan(one, *record, scan, all_memory, best_isa()),
               slabs = rescan(one, *record, scan, no_memory, best_isa());
  EXPECT_EQ(whole.provenance.slabs, 1U);
  EXPECT_EQ(slabs.provenance.slabs, 2U);
  expect_same(whole, slabs);
}

}  // namespace
}  // namespace rabiline::test::form_test
