// Weights split over the levels behind a deflecting magnet, booked from paths that were flown once.
#include <gtest/gtest.h>

#include "physics/suggested.hpp"

namespace rabiline::test::branches_test {
namespace {

constexpr Rectangle gap{6e-3, 0.5e-3};
TallyAxis over(Quantity quantity) {
  TallyAxis axis;
  axis.quantity = quantity;
  return axis;
}

/// A magnet, a field that turns, a second magnet, a monitor and a detector that counts two thirds, both with
/// tallies. An amplitude that drives nothing leaves every particle in its level.
Beamline apparatus(const Species& species, Outcomes outcomes, double amplitude) {
  Beamline b = suggested(1e6);
  b.law = QuantumLaw{outcomes};
  b.species = {{species, 1}};
  b.source = {GaussianSpeed{800, 60}, Rectangle{0.2e-3, 0.1e-3}, BoxDirection{1e-4, 1e-4}};
  b.chamber.reset();
  RotatingField drive;
  drive.length = 0.05;
  drive.amplitude = amplitude;
  drive.frequency = 1e6;
  drive.sense = Sense::positive;
  Monitor monitor{Rectangle{6e-3, 0.4e-3}, {}};
  monitor.tallies = {{"matrix", {over(Quantity::prepared_level), over(Quantity::level)}},
                     {"z", {test::axis(Quantity::z, -4e-4, 4e-4, 9)}}};
  Detector detector{Rectangle{4e-3, 0.6e-3}, {3, 60}, {}};
  detector.efficiency = 2.0 / 3;
  detector.dead = DeadArea{Rectangle{4e-3, 0.02e-3}, {}};
  detector.tallies = {{"matrix", {over(Quantity::prepared_level), over(Quantity::level)}},
                      {"speeds", {test::axis(Quantity::speed, 700, 900, 5)}}};
  b.parts = {place("A", 0.1, magnet(0.1, 8, gap)), place("C", 0.25, UniformField{0.2, 1e-3, {}}),
             place("drive", 0.3, drive),           place("B", 0.5, magnet(0.1, 20, gap)),
             place("look", 0.7, monitor),          place("screen", 0.8, detector)};
  b.particles = 3000;
  return b;
}
Species point() { return {"point", 3e-26, 0, {3}, 2.0 * 9.27e-24 / (3 * 1.0546e-34), ""}; }

void expect_same(const Result& a, const Result& b) {
  ASSERT_EQ(a.fates.size(), b.fates.size());
  for (std::size_t i = 0; i < a.fates.size(); ++i) {
    EXPECT_EQ(a.fates[i].fate + a.fates[i].where, b.fates[i].fate + b.fates[i].where);
    EXPECT_EQ(a.fates[i].quanta_low, b.fates[i].quanta_low) << a.fates[i].fate << a.fates[i].where;
    EXPECT_EQ(a.fates[i].by_level, b.fates[i].by_level) << a.fates[i].fate << a.fates[i].where;
  }
  EXPECT_EQ(a.detectors[0].counts, b.detectors[0].counts);
  EXPECT_EQ(a.detectors[0].counts_errors, b.detectors[0].counts_errors);
  EXPECT_EQ(a.detectors[0].detected_errors, b.detectors[0].detected_errors);
  EXPECT_EQ(a.detectors[0].levels, b.detectors[0].levels);
  EXPECT_EQ(a.detectors[0].levels_errors, b.detectors[0].levels_errors);
  EXPECT_EQ(a.monitors[0].passed, b.monitors[0].passed);
  EXPECT_EQ(a.monitors[0].passed_errors, b.monitors[0].passed_errors);
  ASSERT_EQ(a.tallies.size(), 4U);
  for (std::size_t i = 0; i < a.tallies.size(); ++i) {
    EXPECT_EQ(a.tallies[i].counts, b.tallies[i].counts) << a.tallies[i].name;
    EXPECT_EQ(a.tallies[i].counts_errors, b.tallies[i].counts_errors) << a.tallies[i].name;
    EXPECT_EQ(a.tallies[i].outside, b.tallies[i].outside) << a.tallies[i].name;
  }
  EXPECT_EQ(a.tallies[1].axes[0].mean, b.tallies[1].axes[0].mean);
  EXPECT_EQ(a.tallies[3].axes[0].deviation_errors, b.tallies[3].axes[0].deviation_errors);
}

TEST(Branches, WhoseLevelNeverChangesAreBookedAsIfOneWasDrawn) {
  for (const Species& species : {point(), *find_species("Na-23 atom")}) {
    const Result split = run_points({apparatus(species, Outcomes::split, 1e-30)}),
                 drawn = run_points({apparatus(species, Outcomes::sample, 1e-30)});
    EXPECT_GT(split.detectors[0].detected[0], 0.05);
    EXPECT_LT(split.detectors[0].detected[0], 0.9);
    expect_same(split, drawn);
  }
}

TEST(Branches, OfAScanAreThoseOfEachPointAlone) {
  for (const Species& species : {point(), *find_species("Na-23 atom")}) {
    const Beamline weak = apparatus(species, Outcomes::split, 1e-5),
                   strong = apparatus(species, Outcomes::split, 3e-5);
    const Result both = run_points({weak, strong}), alone = run_points({strong});
    EXPECT_EQ(both.detectors[0].detected[1], alone.detectors[0].detected[0]);
    EXPECT_EQ(both.detectors[0].detected_errors[1], alone.detectors[0].detected_errors[0]);
    EXPECT_NE(both.detectors[0].detected[0], both.detectors[0].detected[1]);
    const std::vector<double>& counts = both.tallies[0].counts;
    EXPECT_EQ(
        std::vector<double>(counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2), counts.end()),
        alone.tallies[0].counts);
  }
}

TEST(Branches, DoNotDependOnBatchesThreadsAndInstructionSets) {
  const Beamline b = apparatus(*find_species("Na-23 atom"), Outcomes::split, 3e-5);
  const Result one = run_points({b});
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
    if (!supported(isa)) continue;
    Experiment e;
    e.points = {b};
    RunOptions options;
    options.isa = isa;
    options.threads = 3;
    options.batch = isa == Isa::baseline ? 512 : 40;
    const Plan plan = make_plan(e);
    expect_same(one, finish(e, plan, run(plan, options).sums));
  }
}

}  // namespace
}  // namespace rabiline::test::branches_test
