#include "simulation/finish.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "physics/suggested.hpp"
#include "simulation/counting.hpp"

namespace rabiline::finish_test {
namespace {

using test::run_points;
using test::suggested;

Beamline divergent(std::uint64_t seed) {
  Beamline b = suggested(291e3);
  b.law = QuantumLaw{};
  b.source.direction = GaussianDirection{1.5e-3, 1.5e-3};
  b.seed = seed;
  b.particles = 3001;
  return b;
}

TEST(Wilson, ErrorIsNeverZeroAndNearTheBinomialOneForManyParticles) {
  EXPECT_GT(wilson_error(0, 100), 0);
  EXPECT_EQ(wilson_error(0, 100), wilson_error(100, 100));
  EXPECT_NEAR(wilson_error(3000, 10000), std::sqrt(0.3 * 0.7 / 10000), 1e-6);
}

/// Three levels share each of 32 particles, and each share is rounded down to a quantum.
TEST(Finish, CountsWholeParticlesHoweverTheirSharesWereRounded) {
  const Sum each = counted_of_one(0.7);
  const auto variance = [&](Sum weight) {
    return variance_of({32 * weight, 32 * weight * weight}, 3000, static_cast<std::uint64_t>(each));
  };
  EXPECT_NEAR(variance(each - 3), variance(each), 1e-9);
  EXPECT_GT(variance(each) - variance(each - each / 1'000'000), 0.05);
}

TEST(Finish, AddsUpFatesHistogramsAndFractions) {
  const Result r = run_points({divergent(1)});
  double sum = 0;
  for (const FateResult& f : r.fates) sum += f.particles.at(0);
  EXPECT_EQ(sum, 3001);
  const DetectorResult& d = r.detectors.at(0);
  double counts = 0, along_x = 0, along_z = 0;
  for (const double c : d.counts) counts += c;
  for (const double c : d.counts_x) along_x += c;
  for (const double c : d.counts_z) along_z += c;
  EXPECT_EQ(counts, along_x);
  EXPECT_EQ(counts, along_z);
  EXPECT_DOUBLE_EQ(d.detected.at(0), counts / 3001);
}

TEST(Finish, QuotesTheErrorThatRepeatedRunsScatterBy) {
  std::vector<double> values;
  double error = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Result r = run_points({divergent(seed)});
    values.push_back(r.detectors[0].detected[0]);
    error = r.detectors[0].detected_errors[0];
  }
  double mean = 0, square = 0;
  for (const double v : values) mean += v / 200;
  for (const double v : values) square += (v - mean) * (v - mean) / 199;
  EXPECT_NEAR(std::sqrt(square) / error, 1,
              4 / std::sqrt(2 * 199.0));  // four standard errors of a standard deviation
}

TEST(Finish, GivesPointsThatShareParticlesTheirCovariance) {
  Beamline near = divergent(1), far = near;
  std::get<Detector>(far.parts.back().part).face = Rectangle{3e-3, 4e-3};
  const Result r = run_points({near, far, near});
  const DetectorResult& d = r.detectors.at(0);
  const double variance = d.detected_covariance.at(0);
  EXPECT_DOUBLE_EQ(std::sqrt(variance), d.detected_errors[0]);
  EXPECT_DOUBLE_EQ(d.detected_covariance.at(2), variance);  // the same point twice
  // Everything that the narrow screen catches, the wide one does: cov = p_narrow (1 - p_wide)/N.
  const double expected = d.detected[1] * (1 - d.detected[0]) / 3001;
  EXPECT_NEAR(d.detected_covariance.at(1), expected, 4 * variance / std::sqrt(255.0));
}

TEST(Finish, KnowsThatTheSharesOfAMixtureAreNotRandom) {
  // One species is always caught, the other never: the count cannot scatter.
  Beamline b = suggested(291.65e3);
  Species dark = test::neutron();
  dark.name = "dark";
  dark.gyromagnetic_ratio = 0;
  b.species = {{test::neutron(), 0.4}, {dark, 0.6}};
  b.particles = 1000;
  const DetectorResult d = run_points({b, b}).detectors[0];
  EXPECT_EQ(d.detected[0], 0.6);
  EXPECT_LT(d.detected_errors[0], 2 * wilson_error(0, 400));
  EXPECT_DOUBLE_EQ(d.detected_covariance[0], d.detected_errors[0] * d.detected_errors[0]);
  EXPECT_EQ(d.detected_covariance[1], 0);
}

/// Fields of every kind behind a polarizer, then a screen that catches a part of the beam.
std::vector<Part> fields_of_every_kind() {
  RotatingField plain;
  plain.length = 0.1;
  plain.amplitude = 20e-6;
  plain.frequency = 100;
  plain.sense = Sense::co;
  RotatingField swelling = plain, twisted = plain;
  swelling.profile = HalfSineProfile{};
  twisted.twist = 1.5;
  OscillatingField whole;
  whole.length = 0.1;
  whole.amplitude = 20e-6;
  whole.frequency = 100;
  whole.approximation = Approximation::none;
  UniformField across{0.1, 5e-6, {}};
  across.direction = {1, 0, 0};
  return {plain, swelling, twisted, whole, across, GuideField{0.1, 0.3e-3, {0, 0, 1}, {1, 0, 0}, {}}};
}

TEST(Finish, FindsTheSameLevelsWhereAScreenCatchesAPartOfTheBeam) {
  for (const Law& law : {Law{QuantumLaw{}}, Law{ClassicalLaw{}}})
    for (const Part& field : fields_of_every_kind()) {
      Beamline b = suggested(0);
      b.law = law;
      b.source = {SingleSpeed{1000}, Rectangle{2e-3, 2e-3}, ParallelDirection{}};
      b.chamber.reset();
      b.parts = {test::place("P", 0.05, Polarizer{0.02, 1e-3, 1, {}}), test::place("F", 0.1, field),
                 test::place("screen", 0.5, Detector{Rectangle{5e-3, 5e-3}, {1, 1}, {}})};
      b.particles = 2000;
      const std::vector<double> whole = run_points({b}).detectors[0].levels;
      std::get<Detector>(b.parts.back().part).face = Rectangle{1e-3, 1e-3};
      const DetectorResult part = run_points({b}).detectors[0];
      EXPECT_LT(part.detected[0], 0.5);
      EXPECT_NEAR(part.levels[0] + part.levels[1], 1, 1e-11);
      EXPECT_NEAR(part.levels[0], whole[0], 1e-9);
    }
}

/// Scatter of numbers over seeds, and the mean of their stated errors.
struct Scatter {
  double sum = 0, squares = 0, stated = 0, n = 0;
  void add(double value, double error) {
    sum += value;
    squares += value * value;
    stated += error;
    ++n;
  }
  double seen() const { return std::sqrt((squares - sum * sum / n) / (n - 1)); }
  double ratio() const { return stated / n / seen(); }
};

TEST(Finish, StatesErrorsBehindFiltersThatTheScatterOverSeedsBearsOut) {
  // 60 seeds tell a scatter to 9 %.
  for (const int twice_spin : {1, 3}) {
    Scatter level, detected;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
      Beamline b = suggested(0);
      b.law = twice_spin == 1 ? Law{QuantumLaw{}} : Law{ClassicalLaw{}};
      b.species[0].species.spin = {twice_spin};
      b.source = {SingleSpeed{1000}, Rectangle{2e-3, 2e-3}, ParallelDirection{}};
      b.parts = {test::place("F", 0.1, SpinFilter{UnitVector{0, 0, 1}, 0.9, 0.1, {}}),
                 test::place("screen", 0.5, Detector{Rectangle{1e-3, 5e-3}, {1, 1}, {}})};
      b.particles = 1000;
      b.seed = seed;
      const DetectorResult d = run_points({b}).detectors[0];
      level.add(d.levels[0], d.levels_errors[0]);
      detected.add(d.detected[0], d.detected_errors[0]);
      EXPECT_NEAR(d.levels_errors[0], d.levels_errors[1], 1e-9);
    }
    EXPECT_NEAR(level.ratio(), 1, 0.35);
    EXPECT_NEAR(detected.ratio(), 1, 0.35);
  }
}

TEST(Finish, StatesErrorsOfManyLevelsThatTheScatterOverSeedsBearsOut) {
  Scatter level;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Beamline b = suggested(0);
    b.law = QuantumLaw{};
    b.species[0].species.spin = {3};
    RotatingField rf;
    rf.length = 0.1;
    rf.amplitude = 40e-6;
    rf.frequency = 0;
    rf.sense = Sense::co;
    b.source = {GaussianSpeed{1000, 200}, Rectangle{2e-3, 2e-3}, ParallelDirection{}};
    b.parts = {test::place("RF", 0.1, rf),
               test::place("screen", 0.5, Detector{Rectangle{1e-3, 5e-3}, {1, 1}, {}})};
    b.particles = 1000;
    b.seed = seed;
    const DetectorResult d = run_points({b}).detectors[0];
    level.add(d.levels[1], d.levels_errors[1]);
  }
  EXPECT_NEAR(level.ratio(), 1, 0.35);
}

TEST(Finish, StatesErrorsOfAimedSourcesThatTheScatterOverSeedsBearsOut) {
  Scatter detected, rate;
  double spread = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Beamline b = divergent(1);
    b.source.direction = AimedDirection{"S"};
    b.source.rate = 1e6;
    b.parts = {test::place("S", 0.1, Slit{Rectangle{0.3, 0.3}, {}}),
               test::place("F", 0.12, SpinFilter{UnitVector{0, 0, 1}, 0.5, 0.5, {}}),
               test::place("screen", 0.2, Detector{Rectangle{0.3, 0.3}, {1, 1}, {}})};
    b.chamber.reset();
    b.law = QuantumLaw{};
    b.particles = 1000;
    b.seed = seed;
    const Result r = run_points({b, b});
    detected.add(r.detectors[0].detected[0], r.detectors[0].detected_errors[0]);
    rate.add(r.detectors[0].count_rate[0], r.detectors[0].count_rate_errors[0]);
    spread += std::sqrt(r.detectors[0].detected_covariance[1]) / r.detectors[0].detected_errors[0] / 60;
  }
  EXPECT_NEAR(detected.ratio(), 1, 0.35);
  EXPECT_NEAR(rate.ratio(), 1, 0.35);
  EXPECT_NEAR(spread, 1, 1e-9);
}

TEST(Finish, HasNoErrorWhereAnAimedSourceLosesNothing) {
  Beamline b = divergent(1);
  b.parts.insert(b.parts.begin(), test::place("S", 0.01, Slit{Rectangle{1e-2, 1e-2}, {}}));
  b.parts.back() = test::place("screen", 0.02, Detector{Rectangle{1, 1}, {1, 1}, {}});
  b.parts.erase(b.parts.begin() + 1, b.parts.end() - 1);
  b.source.direction = AimedDirection{"S"};
  const DetectorResult d = run_points({b}).detectors[0];
  EXPECT_EQ(d.detected[0], 1);
  EXPECT_LT(d.detected_errors[0], 1e-9);
}

TEST(Finish, WeighsAnAimedSourceLikeAnIsotropicOne) {
  // Emitted isotropically within 60 degrees, or aimed at the slit with its solid angle as a factor: the same
  // rate.
  Beamline cone = divergent(3);
  cone.parts.insert(cone.parts.begin(), test::place("S", 0.003, Slit{Rectangle{4e-3, 6e-3}, {1e-3, 0}}));
  cone.parts.back() = test::place("screen", 0.004, Detector{Rectangle{4e-3, 4e-3}, {1, 1}, {}});
  cone.parts.erase(cone.parts.begin() + 1, cone.parts.end() - 1);
  cone.source.direction = ConeDirection{std::numbers::pi / 3};
  cone.particles = 200000;
  Beamline aimed = cone;
  aimed.source.direction = AimedDirection{"S"};
  const Result a = run_points({cone}), b = run_points({aimed});
  const double cone_angle = 2 * std::numbers::pi * (1 - std::cos(std::numbers::pi / 3));
  const double rate_a = a.detectors[0].detected[0] * cone_angle;
  const double rate_b = b.detectors[0].detected[0] * b.emitted[0] / 200000 * b.solid_angle;
  const double error = std::hypot(a.detectors[0].detected_errors[0] * cone_angle,
                                  b.detectors[0].detected_errors[0] * b.solid_angle);
  EXPECT_DOUBLE_EQ(b.solid_angle, 4e-3 * 6e-3 / 9e-6);
  EXPECT_NEAR(rate_a, rate_b, 4 * error);
  EXPECT_LT(4 * error, 0.03 * rate_a);
}

TEST(Finish, CountsInTheFrameOfAScreenThatAScanMoves) {
  Beamline left = divergent(1), right = left, middle = left;
  const auto screen_at = [](double x) { return Detector{Rectangle{2e-3, 4e-3}, {4, 1}, {x, 0}}; };
  left.parts.back().part = screen_at(-1e-3);
  middle.parts.back().part = screen_at(0);
  right.parts.back().part = screen_at(1e-3);
  const DetectorResult d = run_points({left, middle, right}).detectors[0];
  EXPECT_EQ(d.x.edges, (std::vector<double>{-1e-3, -0.5e-3, 0, 0.5e-3, 1e-3}));
  EXPECT_EQ(d.offset_x, (std::vector<double>{-1e-3, 0, 1e-3}));
  // The right half of the left screen is the left half of the middle one, and so on.
  for (const std::size_t bin : {0, 1}) {
    EXPECT_EQ(d.counts_x[2 + bin], d.counts_x[4 + bin]);
    EXPECT_EQ(d.counts_x[4 + 2 + bin], d.counts_x[8 + bin]);
    EXPECT_GT(d.counts_x[4 + bin], 0);
  }
  const DetectorResult fixed = run_points({right, right}).detectors[0];
  EXPECT_TRUE(fixed.offset_x.empty());
  EXPECT_EQ(fixed.x.edges.front(), 0);
}

TEST(Finish, LabelsTheLevelsOfEverySpinAndEverySpeciesOfAMixture) {
  Beamline b = divergent(1);
  EXPECT_EQ(run_points({b}).detectors[0].level_labels, (std::vector<std::string>{"m = +1/2", "m = -1/2"}));
  Beamline one = b, vector = b;
  one.species[0].species.spin = {2};
  vector.law = ClassicalLaw{};
  EXPECT_EQ(run_points({one}).detectors[0].level_labels,
            (std::vector<std::string>{"m = +1", "m = 0", "m = -1"}));
  const DetectorResult both = run_points({b, vector}).detectors[0];
  ASSERT_EQ(both.level_labels,
            (std::vector<std::string>{"m = +1/2", "m = -1/2", "(1 + S_z)/2", "(1 - S_z)/2"}));
  EXPECT_TRUE(std::isnan(both.levels[2]));
  EXPECT_NEAR(both.levels[4 + 3], 1, 1e-3);
  b.species.push_back({one.species[0].species, 0.5});
  b.species[0].fraction = 0.5;
  b.species[1].species.name = "other";
  const DetectorResult mixed = run_points({b}).detectors[0];
  EXPECT_EQ(mixed.level_labels.size(), 5U);
  EXPECT_EQ(mixed.level_labels[1], "neutron m = -1/2");
  EXPECT_NEAR(mixed.levels[1], 0.5, 0.05);
}

TEST(Finish, MakesAPointNoMoreOftenForManyMonitors) {
  const auto makes_with = [](int monitors) {
    Beamline b = divergent(1);
    b.particles = 16;
    for (int i = 0; i < monitors; ++i) {
      Monitor monitor{Rectangle{1e-2, 1e-2}, {}};
      monitor.tallies = {{"speeds", {test::axis(Quantity::speed, 900, 1100, 2)}}};
      b.parts.push_back(test::place("m" + std::to_string(i), 0.6 + 1e-3 * i, monitor));
    }
    std::ranges::stable_sort(b.parts, {}, [](const PlacedPart& part) { return part.placement.at; });
    int made = 0;
    Experiment e;
    e.points = {3, [&](std::size_t) {
                  ++made;
                  return b;
                }};
    const Plan plan = make_plan(e);
    RunOptions options;
    Sums sums = run(plan, options).sums;
    made = 0;
    finish(e, plan, std::move(sums));
    return made;
  };
  EXPECT_EQ(makes_with(2), makes_with(20));
}

}  // namespace
}  // namespace rabiline::finish_test
