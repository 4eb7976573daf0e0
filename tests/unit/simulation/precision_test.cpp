// Runs that end when a part of their particles tells enough.
#include "simulation/precision.hpp"

#include <gtest/gtest.h>

#include "apparatus.hpp"
#include "simulation/work.hpp"

namespace rabiline::test {
namespace {

/// Half of the particles pass: the error of `detected` is close to 1/(2 sqrt N).
Experiment half_detected(std::uint64_t particles, double error) {
  Beamline b = suggested(291e3);
  b.law = QuantumLaw{};
  b.particles = particles;
  b.source = {GaussianSpeed{1000, 10}, Rectangle{4e-3, 1e-4}, ParallelDirection{}};
  b.parts.back() = place("screen", 1.2, Detector{Rectangle{2e-3, 4e-3}, {2, 2}, {}});
  b.until = Until{error};
  Experiment e;
  e.points = {b};
  return e;
}
RunOutcome run_until(const Experiment& e, const Plan& plan, RunOptions options = {}) {
  Precision precision(e, plan);
  options.halvings = precision.halvings();
  options.grain = 0;  // eight particles at once, however fast the machine
  options.enough = [&](const Sums& sums, int halvings) { return precision.is_enough(sums, halvings); };
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
      stop = ++seen == 20;
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

}  // namespace
}  // namespace rabiline::test
