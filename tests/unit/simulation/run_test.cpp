#include "simulation/run.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "physics/suggested.hpp"
#include "simulation/work.hpp"

namespace rabiline::run_test {
namespace {

/// A monitor and tallies of everything, a turned disc of some efficiency with a dead area.
void add_tallies(Beamline& b) {
  const auto axis = [](Quantity q, double from, double to) {
    return TallyAxis{q, AxisEnd{from}, AxisEnd{to}, 7, {}};
  };
  TallyAxis spin = axis(Quantity::spin, -1, 0.9);
  spin.axis = UnitVector{0.6, 0, 0.8};
  Monitor monitor{Rectangle{1e-3, 2e-3}, {1e-4, 0}, {0.3}};
  monitor.tallies = {{"a", {axis(Quantity::x, -1e-3, 1e-3), axis(Quantity::angle_x, -1e-3, 2e-3), spin}},
                     {"b", {axis(Quantity::z, -1e-3, 1e-3), axis(Quantity::angle_z, -1e-3, 2e-3)}},
                     {"c", {axis(Quantity::energy, 0, 1e-20), axis(Quantity::angle, 0, 2e-3)}},
                     {"d", {axis(Quantity::wavelength, 0, 1e-9), axis(Quantity::speed, 0, 2e3)}},
                     {"e", {axis(Quantity::time_of_flight, 0, 1e-2), axis(Quantity::weight, 0, 1)}}};
  b.parts.insert(b.parts.end() - 1, test::place("M", 0.95, monitor));
  Detector& screen = std::get<Detector>(b.parts.back().part);
  screen.face = Disc{1.5e-3};
  screen.tilt.y = 0.2;
  screen.efficiency = 0.37;
  screen.dead = DeadArea{Rectangle{1e-4, 1e-3}, {}};
  screen.tallies = monitor.tallies;
}

/// Five planes, before, inside and behind the fields.
void add_path(Beamline& b) {
  const auto axis = [](Quantity q, double from, double to) {
    return TallyAxis{q, AxisEnd{from}, AxisEnd{to}, 7, {}};
  };
  Monitor path{Disc{0.02}, {}};
  path.length = 0.4;
  path.planes = 5;
  path.tallies = {{"x", {axis(Quantity::x, -1e-3, 1e-3), axis(Quantity::time_of_flight, 0, 1e-3)}}};
  if (!std::holds_alternative<QuantumLaw>(b.law))
    path.tallies.push_back({"angles",
                            {axis(Quantity::spin_polar_angle, 0, 3), axis(Quantity::spin_azimuth, -3, 3),
                             axis(Quantity::angle_x, -1e-3, 1e-3)}});
  b.parts.insert(b.parts.end() - 1, test::place("path", 0.25, path));
}

/// A small scan with every kind of stage: three laws, a mixture, a slit, two detectors, a divergent source.
Experiment everything() {
  Experiment e;
  const Species lithium{"Li-7", 1.165e-26, 0, {3}, 1.0397e8, ""};
  for (const Law& law : {Law{QuantumLaw{}}, Law{ClassicalLaw{}}, Law{DoradoLaw{}}})
    for (const double frequency : {290e3, 291.6e3}) {
      Beamline b = test::suggested(frequency);
      b.law = law;
      b.species = {{test::neutron(), 0.5}, {lithium, 0.5}};
      b.source.direction = GaussianDirection{1e-3, 1e-3};
      b.parts.insert(b.parts.begin(), test::place("S", 0.05, Slit{Disc{0.4e-3}, {}}));
      b.parts.insert(b.parts.end() - 1,
                     test::place("small", 0.9, Detector{Rectangle{0.5e-3, 0.5e-3}, {3, 3}, {1e-4, 0}}));
      b.particles = 600;
      add_tallies(b);
      add_path(b);
      e.points.push_back(b);
    }
  return e;
}
Sums sums_of(const Plan& plan, RunOptions options) { return run(plan, options).sums; }

TEST(Run, GivesTheSameBitsForAnyThreadsBatchesAndInstructionSets) {
  const Plan plan = make_plan(everything());
  RunOptions options;
  options.isa = best_isa();
  const Sums expected = sums_of(plan, options);
  for (const int threads : {2, 3, 7}) {
    options.threads = threads;
    EXPECT_TRUE(sums_of(plan, options) == expected) << threads << " threads";
  }
  for (const int batch : {8, 64, 200}) {
    options.batch = batch;
    EXPECT_TRUE(sums_of(plan, options) == expected) << "batches of " << batch;
  }
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
    if (!supported(isa)) continue;
    options.isa = isa;
    EXPECT_TRUE(sums_of(plan, options) == expected) << name_of(isa);
  }
}

TEST(Run, CountsVisitsOfZonesForEachParticleAlone) {
  // Half circles through a field cut by many plates: particles turn back at different ones, nobody circles
  // for ever.
  Experiment e;
  Beamline b = test::suggested(291e3);
  b.law = DoradoLaw{Closure::larmor, 1};
  b.chamber.reset();
  b.source = {GaussianSpeed{900, 150}, Rectangle{0, 0}, ParallelDirection{}};
  b.parts = {test::place("B", 0.30, UniformField{0.25, 1e-4, {}}),
             test::place("screen", 1.2, Detector{Rectangle{1, 1}, {1, 1}, {}})};
  for (int i = 0; i < 60; ++i)
    b.parts.insert(b.parts.end() - 1,
                   test::place("S" + std::to_string(i), 0.301 + 0.001 * i, Slit{Disc{1}, {}}));
  b.particles = 400;
  e.points = {b};
  const Plan plan = make_plan(e);
  RunOptions options;
  options.isa = best_isa();
  const Sums expected = sums_of(plan, options);
  options.isa = Isa::baseline;
  EXPECT_TRUE(sums_of(plan, options) == expected);
  for (const FateResult& fate : finish(e, plan, expected).fates)
    EXPECT_EQ(fate.particles[0], fate.fate == "left_backwards" ? 400 : 0) << fate.fate;
}

TEST(Run, GivesSlowParticlesTheTimeTheyNeed) {
  Beamline b = test::suggested(10, 1e-12);
  b.law = DoradoLaw{Closure::torque, 1e-12};
  b.source.speed = GaussianSpeed{1000, 1000};
  std::get<UniformField>(b.parts[1].part).field = 1e-9;
  b.particles = 50000;
  EXPECT_EQ(test::run_points({b}).detectors[0].detected[0], 1);
}

TEST(Run, GoesOnFromASnapshotToTheSameBits) {
  Experiment e = everything();
  std::vector<Beamline> longer(e.points.begin(), e.points.end());
  for (Beamline& b : longer) b.particles = 10000;
  e.points = std::move(longer);
  const Plan plan = make_plan(e);
  RunOptions options;
  options.isa = best_isa();
  options.grain = 1e-5;
  const Sums expected = sums_of(plan, options);

  std::atomic<bool> stop{false};
  Snapshot kept;
  options.stop = &stop;
  options.snapshot_seconds = 0;
  options.snapshot = [&](const Snapshot& s) {
    kept = s;
    stop = true;
  };
  EXPECT_FALSE(run(plan, options).finished);
  EXPECT_FALSE(kept.finished.empty());

  stop = false;
  options.snapshot = {};
  options.start = &kept;
  options.grain = 1e-3;
  const RunOutcome outcome = run(plan, options);
  EXPECT_TRUE(outcome.finished);
  EXPECT_TRUE(outcome.sums == expected);
}

TEST(Run, GoesOnOnlyFromASnapshotThatFitsItsPlan) {
  const Plan plan = make_plan(everything());
  Snapshot snapshot;
  snapshot.particles = ParticleRow(plan).size();
  snapshot.finished = {{0, snapshot.particles}};
  snapshot.sums.size = plan.sums;
  EXPECT_TRUE(fits(snapshot, plan));
  const auto broken = [&](const std::function<void(Snapshot&)>& change) {
    Snapshot changed = snapshot;
    change(changed);
    return changed;
  };
  EXPECT_FALSE(fits(broken([](Snapshot& s) { s.sums.size -= 1; }), plan));
  EXPECT_FALSE(fits(broken([](Snapshot& s) { s.particles += 1; }), plan));
  EXPECT_FALSE(fits(broken([](Snapshot& s) { s.shard = {2, 2}; }), plan));
  EXPECT_FALSE(fits(broken([](Snapshot& s) { s.finished.back().second += 1; }), plan));
}

TEST(Run, InShardsHasTheSumsOfTheRunInOnePiece) {
  const Plan plan = make_plan(everything());
  RunOptions options;
  options.isa = best_isa();
  const Sums expected = sums_of(plan, options);
  Sums merged(plan.sums);
  for (const std::uint64_t number : {3U, 1U, 2U}) {
    options.shard = {number, 3};
    const RunOutcome outcome = run(plan, options);
    EXPECT_TRUE(outcome.finished);
    EXPECT_FALSE(outcome.sums == expected);
    add(merged, outcome.sums);
  }
  EXPECT_TRUE(merged == expected);
}

TEST(Run, CarriesAnExceptionOutOfItsThreads) {
  const Plan plan = make_plan(everything());
  RunOptions options;
  options.isa = best_isa();
  options.threads = 2;
  options.grain = 1e-6;  // often, so that the reporting thread gets some
  options.snapshot_seconds = 0;
  options.snapshot = [](const Snapshot&) { throw std::runtime_error("disk full"); };
  EXPECT_THROW(run(plan, options), std::runtime_error);
}

TEST(Run, WithAnotherSeedOrStreamGivesOtherParticles) {
  Experiment e = everything();
  RunOptions options;
  options.isa = best_isa();
  const Sums expected = sums_of(make_plan(e), options);
  std::vector<Beamline> reseeded(e.points.begin(), e.points.end());
  for (Beamline& b : reseeded) b.seed = 7;
  e.points = std::move(reseeded);
  EXPECT_FALSE(sums_of(make_plan(e), options) == expected);
}

}  // namespace
}  // namespace rabiline::run_test
