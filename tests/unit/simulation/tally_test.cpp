// Monitors, tallies and what a detector counts of what hits it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "constants.hpp"
#include "physics/suggested.hpp"
#include "plan/explain.hpp"
#include "simulation/finish_tallies.hpp"
#include "simulation/trace.hpp"
#include "slow.hpp"

namespace rabiline::tally_test {
namespace {

using test::axis;
using test::place;
using test::run_points;
using test::suggested;

TallyAxis spin(UnitVector along, std::uint64_t bins) {
  TallyAxis a = axis(Quantity::spin, -1, 1, bins);
  a.axis = along;
  return a;
}
TallyAxis levels(Quantity quantity) { return {quantity, {}, {}, {}, {}}; }

Beamline divergent(std::uint64_t seed = 1) {
  Beamline b = suggested(291e3);
  b.law = QuantumLaw{};
  b.source.direction = GaussianDirection{1.5e-3, 1.5e-3};
  b.seed = seed;
  b.particles = 700;
  return b;
}
Detector& screen(Beamline& b) { return std::get<Detector>(b.parts.back().part); }

double sum(const std::vector<double>& v) {
  double s = 0;
  for (const double x : v) s += x;
  return s;
}
double fate(const Result& r, const std::string& name, const std::string& where) {
  for (const FateResult& f : r.fates)
    if (f.fate == name && f.where == where) return f.particles.at(0);
  return 0;
}

/// What a track's last record gives for a quantity.
double last_of(const Track& t, Quantity quantity) {
  constexpr double h = test::planck, mass = test::neutron_mass;
  const double vx = t.vx.back(), vy = t.vy.back(), vz = t.vz.back(), v = std::hypot(vx, vy, vz);
  switch (quantity) {
    case Quantity::x:
      return t.x.back();
    case Quantity::z:
      return t.z.back();
    case Quantity::y:
      return t.y.back();
    case Quantity::time_of_flight:
      return t.t.back();
    case Quantity::speed:
      return v;
    case Quantity::wavelength:
      return h / mass / v;
    case Quantity::energy:
      return mass * v * v / 2;
    case Quantity::angle_x:
      return std::atan2(vx, vy);
    case Quantity::angle_z:
      return std::atan2(vz, vy);
    case Quantity::angle:
      return std::acos(vy / v);
    default:
      return 1;
  }
}

TEST(Tally, OfStartTimesIsThePulse) {
  Beamline b = divergent();
  b.particles = 20000;
  b.source.pulse = RectanglePulse{2e-3};
  screen(b).tallies = {{"start", {axis(Quantity::start_time, 0, 4e-3, 4)}},
                       {"both", {axis(Quantity::time_of_flight, 0, 9e-3, 1)}}};
  const Result pulsed = run_points({b});
  const std::vector<double>& counts = pulsed.tallies.at(0).counts;
  const double all = sum(counts);
  EXPECT_NEAR(counts.at(0) / all, 0.5, 4 * 0.5 / std::sqrt(all));
  EXPECT_EQ(counts.at(2) + counts.at(3), 0);
  b.source.pulse.reset();
  const Result steady = run_points({b});
  EXPECT_NEAR(steady.tallies.at(0).axes.at(0).mean.at(0), 0, 4e-3 / moment_steps);
  // What is measured against t = 0 of a pulse is start and flight; the flight alone does not know of it.
  const auto mean = [](const Result& r, std::size_t tally) {
    return r.tallies.at(tally).axes.at(0).mean.at(0);
  };
  EXPECT_NEAR(mean(pulsed, 1), mean(pulsed, 0) + mean(steady, 1), 2e-9);
}

SLOW_TEST(Tally, AgreesWithAHistogramOfTracksMadeWithoutIt) {
  Beamline b = divergent();
  screen(b).face = Rectangle{1, 1};
  const std::vector<TallyAxis> all{axis(Quantity::x, -2e-3, 1e-3, 7),
                                   axis(Quantity::z, -1e-3, 3e-3, 9),
                                   axis(Quantity::y, 1, 2, 4),
                                   axis(Quantity::time_of_flight, 1.19e-3, 1.25e-3, 11),
                                   axis(Quantity::speed, 985, 1020, 13),
                                   axis(Quantity::wavelength, 0.39e-9, 0.4e-9, 5),
                                   axis(Quantity::energy, 8.2e-22, 8.6e-22, 6),
                                   axis(Quantity::angle_x, -2e-3, 3e-3, 8),
                                   axis(Quantity::angle_z, -3e-3, 1e-3, 10),
                                   axis(Quantity::angle, 0, 3e-3, 12),
                                   axis(Quantity::weight, 0.5, 1.5, 3)};
  for (std::size_t i = 0; i < all.size(); ++i)
    screen(b).tallies.push_back({"t" + std::to_string(i), {all[i]}});
  const Result r = run_points({b});
  std::vector<Track> tracks;
  for (std::uint64_t p = 0; p < b.particles; ++p) tracks.push_back(trace(b, p, best_isa()));
  for (std::size_t i = 0; i < all.size(); ++i) {
    const TallyAxisResult& a = r.tallies.at(i).axes.at(0);
    SCOPED_TRACE(a.quantity);
    std::vector<double> counts(*all[i].bins, 0.0), inside;
    double outside = 0;
    for (const Track& track : tracks) {
      const double value = last_of(track, all[i].quantity);
      const auto above = std::upper_bound(a.edges.begin(), a.edges.end(), value);
      if (above == a.edges.begin() || above == a.edges.end()) {
        ++outside;
        continue;
      }
      ++counts[static_cast<std::size_t>(above - a.edges.begin()) - 1];
      inside.push_back(value);
    }
    EXPECT_EQ(r.tallies[i].counts, counts);
    EXPECT_EQ(r.tallies[i].outside[0], outside);
    double mean = 0, variance = 0;
    for (const double v : inside) mean += v / static_cast<double>(inside.size());
    for (const double v : inside) variance += (v - mean) * (v - mean) / static_cast<double>(inside.size());
    const double range = a.edges.back() - a.edges.front();
    EXPECT_NEAR(a.mean[0], mean, 1e-7 * range);
    EXPECT_NEAR(a.deviation[0], std::sqrt(variance), 1e-7 * range);
  }
}

TEST(Tally, AddsUpWithWhatIsOutsideToWhatCrossedItsPlane) {
  Beamline b = divergent();
  Monitor monitor{Disc{1e-3}, {}};
  monitor.tallies = {{"zs", {axis(Quantity::z, 0, 1e-4, 3), spin({0, 1, 0}, 3)}},
                     {"states", {levels(Quantity::prepared_level), levels(Quantity::level)}}};
  b.parts.insert(b.parts.begin() + 3, place("M", 0.7, monitor));
  screen(b).tallies = {{"xs", {axis(Quantity::x, 0, 1e-4, 3), axis(Quantity::z, 0, 1, 2)}}};
  screen(b).efficiency = 1 / 3.0;
  const Result r = run_points({b});
  const double passed = r.monitors.at(0).passed[0] * r.emitted[0], detected = fate(r, "detected", "screen");
  EXPECT_GT(passed, 100);
  EXPECT_LT(passed, 600);
  for (const TallyResult& t : r.tallies)
    EXPECT_EQ(sum(t.counts) + t.outside[0], t.of_monitor ? std::round(passed) : detected) << t.name;
}

TEST(Monitor, ChangesNothingBehindIt) {
  Beamline with = divergent(), without = with;
  Monitor monitor{Disc{1e-3}, {}};
  monitor.tallies = {{"a", {spin({1, 0, 0}, 3)}}};
  for (const double at : {0.05, 0.32, 0.4, 0.8}) {
    with.parts.push_back(place("M" + std::to_string(static_cast<int>(100 * at)), at, monitor));
    std::stable_sort(with.parts.begin(), with.parts.end(),
                     [](const auto& a, const auto& b) { return a.placement.at < b.placement.at; });
  }
  const DetectorResult a = run_points({with}).detectors[0], b = run_points({without}).detectors[0];
  EXPECT_EQ(a.counts, b.counts);
  EXPECT_EQ(a.levels, b.levels);
}

TEST(Monitor, QuotesTheErrorAndCovarianceOfADetector) {
  Beamline near = divergent(), far = near;
  for (Beamline* b : {&near, &far}) {
    const Rectangle size{b == &near ? 4e-3 : 3e-3, 4e-3};
    b->parts.insert(b->parts.end() - 1, place("M", 1.2, Monitor{size, {}}));
    screen(*b).face = size;
  }
  const Result r = run_points({near, far});
  EXPECT_EQ(r.monitors[0].passed, r.detectors[0].detected);
  EXPECT_EQ(r.monitors[0].passed_errors, r.detectors[0].detected_errors);
  EXPECT_EQ(r.monitors[0].passed_covariance, r.detectors[0].detected_covariance);
}

TEST(Detector, BooksWhatItsEfficiencyDoesNotCountAsStoppedThere) {
  Beamline b = divergent();
  const Result all = run_points({b});
  screen(b).efficiency = 0.3;
  const Result some = run_points({b});
  const double hit = fate(all, "detected", "screen"), counted = std::floor(0.3 * 0x1p40) * 0x1p-40;
  EXPECT_EQ(fate(some, "detected", "screen"), hit * counted);
  EXPECT_EQ(fate(some, "stopped", "screen"), hit - hit * counted);
  EXPECT_EQ(fate(all, "stopped", "screen"), 0);
  // One count weighs less: so do the binomial errors, those of empty bins too.
  for (std::size_t i = 0; i < all.detectors[0].counts.size(); ++i) {
    EXPECT_DOUBLE_EQ(some.detectors[0].counts[i], counted * all.detectors[0].counts[i]);
    EXPECT_DOUBLE_EQ(some.detectors[0].counts_errors[i], counted * all.detectors[0].counts_errors[i]);
  }
  EXPECT_NEAR(some.detectors[0].levels[0], all.detectors[0].levels[0], 1e-9);
}

TEST(Detector, CountsNothingInItsDeadArea) {
  Beamline b = divergent();
  screen(b).tallies = {{"x", {axis(Quantity::x, -2e-3, 2e-3, 4)}}};
  screen(b).dead = DeadArea{Rectangle{2e-3, 4e-3}, {1e-3, 0}};  // the half at x > 0
  const Result r = run_points({b});
  EXPECT_GT(fate(r, "stopped", "screen"), 100);
  EXPECT_GT(r.tallies[0].counts[1], 50);
  EXPECT_EQ(r.tallies[0].counts[2] + r.tallies[0].counts[3], 0);
  screen(b).dead.reset();
  EXPECT_EQ(fate(run_points({b}), "detected", "screen"),
            fate(r, "detected", "screen") + fate(r, "stopped", "screen"));
}

TEST(Detector, ClosesTheLedgerInsideOfARegionToo) {
  Beamline b = suggested(291e3);
  b.source.direction = GaussianDirection{2e-3, 2e-3};
  Detector inner{Disc{1e-3}, {3, 3}, {}};
  inner.efficiency = 0.3;
  inner.dead = DeadArea{Disc{0.2e-3}, {}};
  inner.tallies = {{"r", {axis(Quantity::x, -1e-3, 1e-3, 10), spin({0, 0, 1}, 10)}}};
  b.parts.insert(b.parts.begin() + 3, place("inner", 0.45, inner));
  const Result r = run_points({b});
  const double counted = std::floor(0.3 * 0x1p40) * 0x1p-40, hits = fate(r, "detected", "inner") / counted;
  EXPECT_EQ(hits, std::round(hits));
  EXPECT_GT(fate(r, "stopped", "inner"), hits * (1 - counted));
  EXPECT_EQ(sum(r.tallies[0].counts) + r.tallies[0].outside[0], fate(r, "detected", "inner"));
  EXPECT_EQ(r.tallies[0].outside[0], 0);
}

TEST(Detector, HistogramsAlongItsOwnAxesWhereItIsTurned) {
  // A narrow screen turned by 90 degrees lies along x: its own z is the laboratory's x, its own x runs down.
  Beamline b = divergent();
  screen(b) = Detector{Rectangle{1e-3, 10e-3}, {1, 4}, {}};
  screen(b).tilt.y = std::numbers::pi / 2;
  screen(b).tallies = {{"lab", {axis(Quantity::x, -5e-3, 5e-3, 4)}}};
  const Result r = run_points({b});
  EXPECT_GT(r.detectors[0].detected[0], 0.1);
  EXPECT_EQ(r.detectors[0].counts_z, r.tallies[0].counts);
}

TEST(Detector, MayBeADisc) {
  Beamline b = divergent();
  screen(b) = Detector{Disc{1e-3}, {2, 2}, {}};
  screen(b).tallies = {{"z", {axis(Quantity::z, -1e-3, 1e-3, 1)}}};
  b.parts.insert(b.parts.end() - 1, place("S", 1.2, Slit{Disc{1e-3}, {}}));
  const Result r = run_points({b});
  EXPECT_EQ(fate(r, "passed", ""), 0);
  EXPECT_EQ(fate(r, "detected", "screen"), r.tallies[0].counts[0]);
  EXPECT_EQ(r.detectors[0].x.edges.front(), -1e-3);
}

TEST(Tally, QuotesTheErrorsThatRepeatedRunsScatterBy) {
  constexpr int runs = 150;
  std::vector<double> mean, deviation, count;
  double errors[3] = {};
  for (int seed = 1; seed <= runs; ++seed) {
    Beamline b = divergent(static_cast<std::uint64_t>(seed));
    screen(b).efficiency = 0.6;
    screen(b).tallies = {{"x", {axis(Quantity::x, -2e-3, 2e-3, 3)}}};
    const TallyResult t = run_points({b}).tallies[0];
    mean.push_back(t.axes[0].mean[0]);
    deviation.push_back(t.axes[0].deviation[0]);
    count.push_back(t.counts[1]);
    errors[0] += t.axes[0].mean_errors[0] / runs;
    errors[1] += t.axes[0].deviation_errors[0] / runs;
    errors[2] += t.counts_errors[1] / runs;
  }
  const std::vector<double>* found[] = {&mean, &deviation, &count};
  for (int k = 0; k < 3; ++k) {
    const double middle = sum(*found[k]) / runs;
    double square = 0;
    for (const double v : *found[k]) square += (v - middle) * (v - middle) / (runs - 1);
    EXPECT_NEAR(std::sqrt(square) / errors[k], 1, 4 / std::sqrt(2.0 * (runs - 1))) << k;
  }
}

TEST(Moments, AreExactWhereTheSumsFill128Bits) {
  // 10^12 particles of full weight, one step from the end of the axis and at its end.
  const auto q = static_cast<Sum>(quanta_per_particle) * 500'000'000'000ULL;
  const Sum u = (1U << 24) - 1;
  MomentSums low{q, q * (u - 1), q * (u - 1) * (u - 1)}, high{q, q * u, q * u * u};
  const MeanAndDeviation m = moments_of({low, high});
  EXPECT_EQ(m.mean, static_cast<double>(u) - 0.5);
  EXPECT_EQ(m.deviation, 0.5);
  EXPECT_TRUE(std::isnan(moments_of({MomentSums{}, MomentSums{}}).mean));
}

// Sums that follow from moments of the slowness are rounded: a second moment may be less than nothing.
TEST(MomentsOf, OfOnePlaceHaveNoDeviationHoweverTheyAreRounded) {
  const Sum q = quanta_per_particle, u = (Sum{1} << 24) - 1;
  for (const Sum off : {Sum{0}, Sum{1}, Sum{12345}}) {
    const MomentSums rounded{q, q * u, q * u * u - off};
    const MeanAndDeviation m = moments_of({rounded, rounded});
    EXPECT_EQ(m.mean, static_cast<double>(u));
    EXPECT_EQ(m.deviation, 0);
    EXPECT_EQ(m.deviation_error, 0);
  }
}

TEST(Plan, SharesTalliesThatAskForNoSpinAndAllThatFollowsThoseThatDo) {
  Experiment e;
  for (int i = 0; i < 5; ++i) {
    Beamline b = divergent();
    std::get<RotatingField>(b.parts[2].part).frequency = 290e3 + 1e3 * i;
    Monitor monitor{Disc{1e-3}, {}};
    monitor.tallies = {{"states", {levels(Quantity::level)}}, {"x", {axis(Quantity::x, 0, 1, 2)}}};
    b.parts.insert(b.parts.end() - 1, place("M", 0.7, monitor));
    screen(b).tallies = monitor.tallies;
    e.points.push_back(b);
  }
  const Plan plan = make_plan(e);
  ASSERT_EQ(plan.trees.size(), 1U);
  std::size_t histograms = 0, scores = 0;
  const auto count = [&](const auto& self, const std::vector<PlanNode>& nodes) -> void {
    for (const PlanNode& node : nodes) {
      histograms += std::holds_alternative<Histogram>(node.stage) ? 1 : 0;
      scores += std::holds_alternative<Score>(node.stage) ? 1 : 0;
      self(self, node.next);
    }
  };
  count(count, plan.trees[0].next);
  EXPECT_EQ(scores, 1U);
  EXPECT_EQ(histograms, 2 * (5U + 1U));
  EXPECT_THAT(explain(e, plan), testing::HasSubstr("M tallies states: level (2 bins)"));
}

}  // namespace
}  // namespace rabiline::tally_test
