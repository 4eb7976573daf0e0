// Runs that end when a part of their particles tells enough.
#include "simulation/precision.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "apparatus.hpp"
#include "simulation/line_centre.hpp"
#include "simulation/work.hpp"

namespace rabiline::test::precision_test {
namespace {

/// Half of the particles pass: the error of `detected` is close to 1/(2 sqrt N).
Experiment half_detected(std::uint64_t particles, double error) {
  Beamline b = suggested(291e3);
  b.law = QuantumLaw{};
  b.particles = particles;
  b.source = {GaussianSpeed{1000, 10}, Rectangle{4e-3, 1e-4}, ParallelDirection{}};
  b.parts.back() = place("screen", 1.2, Detector{Rectangle{2e-3, 4e-3}, {2, 2}, {}});
  b.until = Until{error, {}};
  Experiment e;
  e.points = {b};
  return e;
}
RunOutcome run_until(const Experiment& e, const Plan& plan, RunOptions options = {}) {
  Precision precision(e);
  options.halvings = precision.halvings();
  options.grain = 0;  // eight particles at once, however fast the machine
  options.enough = [&](const Sums& sums, const std::vector<Straggler>&, int halvings) {
    return precision.is_enough(finish(part_of(e, plan, halvings), part_of(plan, halvings), sums));
  };
  return run(plan, options);
}
Result finish_part(const Experiment& e, const Plan& plan, RunOutcome outcome) {
  return finish(part_of(e, plan, outcome.halvings), part_of(plan, outcome.halvings), std::move(outcome.sums));
}

TEST(Until, EndsTheRunAtTheFirstPartThatIsPreciseEnough) {
  const Experiment e = half_detected(64000, 0.5 / std::sqrt(6000.0));
  const Plan plan = make_plan(e);
  RunOutcome outcome = run_until(e, plan);
  EXPECT_TRUE(outcome.finished);
  EXPECT_EQ(outcome.halvings, 3);
  const Result result = finish_part(e, plan, std::move(outcome));
  EXPECT_EQ(result.particles, 8000U);
  EXPECT_EQ(result.emitted[0], 8000);
  EXPECT_NEAR(result.detectors[0].detected_errors[0], 0.5 / std::sqrt(8000.0), 1e-5);
  // The same particles as those of a run with 8000.
  Beamline fewer = e.points.front();
  fewer.particles = 8000;
  EXPECT_EQ(run_points({fewer}).detectors[0].counts, result.detectors[0].counts);
}
TEST(Until, DoesNotEndWhereADetectorHasCaughtLittleByChance) {
  // One in a thousand is detected: 3e-4 takes 11,100 particles, and zero of 500 is no answer.
  constexpr int seeds = 40;
  double sum = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Experiment e = half_detected(64000, 3e-4);
    Beamline b = e.points.front();
    b.seed = seed;
    b.parts.back() = place("screen", 1.2, Detector{Rectangle{4e-6, 4e-3}, {1, 1}, {}});
    e.points = {b};
    const Plan plan = make_plan(e);
    const Result result = finish_part(e, plan, run_until(e, plan));
    EXPECT_GE(result.particles, 8000U) << seed;
    sum += result.detectors[0].detected[0];
  }
  EXPECT_NEAR(sum / seeds, 1e-3, 0.15e-3);  // a quarter of it in each, over the root of 40, 4 times; ends at
                                            // low counts had made it 0.28e-3 too small
}
TEST(Until, FliesAllParticlesWhereTheyAreTooFew) {
  const Experiment e = half_detected(9000, 1e-5);
  const Plan plan = make_plan(e);
  const RunOutcome outcome = run_until(e, plan);
  EXPECT_TRUE(outcome.finished);
  EXPECT_EQ(outcome.halvings, 0);
  EXPECT_EQ(finish_part(e, plan, outcome).particles, 9000U);
}
TEST(Until, GivesTheSameBitsForAnyThreadsAndHoweverOftenTheRunWasStopped) {
  const Experiment e = half_detected(64000, 0.5 / std::sqrt(20000.0));
  const Plan plan = make_plan(e);
  const RunOutcome whole = run_until(e, plan);
  EXPECT_EQ(whole.halvings, 1);
  RunOptions options;
  options.threads = 3;
  EXPECT_EQ(run_until(e, plan, options).sums, whole.sums);

  std::optional<Snapshot> snapshot;
  for (int starts = 0; starts < 200; ++starts) {
    std::atomic<bool> stop = false;
    RunOptions interrupted;
    interrupted.stop = &stop;
    interrupted.snapshot_seconds = 0;
    interrupted.grain = 1e-6;
    int seen = 0;
    std::optional<Snapshot> last;
    interrupted.snapshot = [&](const Snapshot& s) {
      last = s;
      stop = ++seen == 5;
    };
    const std::optional<Snapshot> begin = snapshot;
    if (begin) {
      ASSERT_TRUE(fits(*begin, plan));
      interrupted.start = &*begin;
    }
    const RunOutcome outcome = run_until(e, plan, interrupted);
    if (outcome.finished) {
      EXPECT_EQ(outcome.halvings, whole.halvings);
      EXPECT_EQ(outcome.sums, whole.sums);
      EXPECT_GT(starts, 0);
      return;
    }
    snapshot = last;
  }
  ADD_FAILURE() << "it never ended";
}
TEST(Until, KeepsTheSharesOfAMixture) {
  Experiment e = half_detected(64000, 0.5 / std::sqrt(6000.0));
  Beamline b = e.points.front();
  b.species = {{neutron(), 0.75}, {point_of_spin(1), 0.25}};
  e.points = {b};
  const Plan plan = make_plan(e);
  const Plan part = part_of(plan, 3);
  ASSERT_EQ(part.trees.size(), 2U);
  EXPECT_EQ(part.trees[0].last - part.trees[0].first, 6000U);
  EXPECT_EQ(part.trees[1].last - part.trees[1].first, 2000U);
  EXPECT_EQ(part_of(e, plan, 3).points[0].particles, 8000U);
}
TEST(Until, NeverTrustsLessThanAThousandParticles) {
  EXPECT_EQ(most_halvings(999), 0);
  EXPECT_EQ(most_halvings(2000), 1);
  EXPECT_EQ(most_halvings(1 << 20), 10);
}

/// A line whose points each have an error of their own.
DetectorResult bell(const std::vector<double>& x, double error) {
  DetectorResult detector;
  for (const double at : x) {
    detector.detected.push_back(0.2 + 0.5 * std::exp(-at * at));
    detector.detected_errors.push_back(error);
  }
  return detector;
}
TEST(ErrorOfCentre, IsThatOfAFitOfTheLineToItself) {
  // Of independent points sigma/sqrt(sum f'^2): a bell is even, so neither height nor baseline takes a part.
  std::vector<double> x;
  double slopes = 0;
  for (int i = -40; i <= 40; ++i) {
    x.push_back(0.1 * i);
    slopes += std::pow(2 * x.back() * 0.5 * std::exp(-x.back() * x.back()), 2);
  }
  const double error = error_of_centre(x, bell(x, 1e-3));
  EXPECT_NEAR(error, 1e-3 / std::sqrt(slopes), 0.01 * error);
  // The order of the points does not matter.
  DetectorResult turned = bell(x, 1e-3);
  std::reverse(x.begin(), x.end());
  std::reverse(turned.detected.begin(), turned.detected.end());
  EXPECT_DOUBLE_EQ(error_of_centre(x, turned), error);
}
TEST(ErrorOfCentre, IsUnknownWhereChanceMakesTheSlopes) {
  std::vector<double> x;
  for (int i = -10; i <= 10; ++i) x.push_back(0.4 * i);
  EXPECT_TRUE(std::isfinite(error_of_centre(x, bell(x, 1e-2))));
  EXPECT_FALSE(std::isfinite(error_of_centre(x, bell(x, 0.3))));
  DetectorResult flat = bell(x, 0.01);
  flat.detected.assign(x.size(), 0.4);
  EXPECT_FALSE(std::isfinite(error_of_centre(x, flat)));
}

/// Rabi's apparatus on either side of its resonance.
/// With particles of its own at each point: the same ones make a line whose place hardly is by chance.
Experiment scanned_line(std::uint64_t seed, std::uint64_t particles) {
  Apparatus apparatus;
  apparatus.particles = particles;
  Experiment e;
  std::vector<Beamline> points = apparatus.scan(11);
  ScanAxis axis{"drive.frequency", Dimension::frequency, {}, {}};
  for (Beamline& b : points) {
    b.seed = seed;
    axis.values.push_back(*std::get<RotatingField>(b.parts[2].part).frequency);
  }
  e.axes = {axis};
  e.particles = ScanParticles::independent;
  e.points = points;
  return e;
}
/// The scatter of c in a + b f(x - c), with f the mean of all runs, over the error that each run states.
TEST(ErrorOfCentre, IsTheScatterOfFits) {
  constexpr int runs = 40;
  std::vector<DetectorResult> curves;
  std::vector<double> x, mean(11);
  double stated2 = 0;
  for (int k = 0; k < runs; ++k) {
    const Experiment e = scanned_line(static_cast<std::uint64_t>(k) + 1, 16000);
    const Plan plan = make_plan(e);
    x = e.axes[0].values;
    curves.push_back(finish(e, plan, run(plan, {}).sums).detectors[0]);
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += curves.back().detected[i] / runs;
    stated2 += std::pow(error_of_centre(x, curves.back()), 2) / runs;
  }
  Eigen::MatrixXd model(11, 3);
  for (Eigen::Index i = 0; i < 11; ++i) {
    const auto at = [&](Eigen::Index j) {
      return static_cast<std::size_t>(std::clamp<Eigen::Index>(j, 0, 10));
    };
    model.row(i) << 1, mean[at(i)], -(mean[at(i + 1)] - mean[at(i - 1)]) / (x[at(i + 1)] - x[at(i - 1)]);
  }
  double scatter2 = 0;
  for (const DetectorResult& curve : curves) {
    const Eigen::Map<const Eigen::VectorXd> y(curve.detected.data(), 11);
    scatter2 += std::pow((model.transpose() * model).ldlt().solve(model.transpose() * y)(2), 2) / runs;
  }
  ASSERT_TRUE(std::isfinite(stated2));
  // Of 40 runs the scatter is known to 11 %.
  EXPECT_NEAR(std::sqrt(scatter2 / stated2), 1, 0.35);
}
TEST(Until, EndsWhereTheCentreOfTheLineIsKnown) {
  Experiment e = scanned_line(1, 64000);
  const Plan all = make_plan(e);
  const Result whole = finish(e, all, run(all, {}).sums);
  const double known = error_of_centre(e.axes[0].values, whole.detectors[0]);
  std::vector<Beamline> points(e.points.begin(), e.points.end());
  // A quarter of the particles makes the error twice as large, an eighth 2.8 times.
  for (Beamline& b : points) b.until = Until{{}, ScannedQuantity{2.4 * known, Dimension::frequency}};
  e.points = points;
  const Plan plan = make_plan(e);
  const RunOutcome outcome = run_until(e, plan);
  EXPECT_TRUE(outcome.finished);
  EXPECT_EQ(outcome.halvings, 2);
  // Both precisions are asked for where both are given.
  const double detected = reached_by(whole, {}).detected_error;
  for (Beamline& b : points) b.until->detected_error = 1.2 * detected;
  e.points = points;
  EXPECT_EQ(run_until(e, make_plan(e)).halvings, 0);
}

}  // namespace
}  // namespace rabiline::test::precision_test
