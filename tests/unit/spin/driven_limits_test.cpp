// Driven levels on several clocks, and at the limits of what may drive them.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "drives.hpp"
#include "laboratory.hpp"
#include "spin/driven_levels.hpp"
#include "unit/transport/readers.hpp"

namespace rabiline::driven_limits_test {
namespace {

TEST(DrivenLevels, WithRandomClocksAreTheMeanOverAllStartPhases) {
  // Two clocks between the hyperfine levels and one within them, each free against the others.
  const CoupledSpins spins = small_atom(3, 1);
  const double field = 1e-6, s = 3e-3;
  const double f = transition_frequency(levels_at(spins, field), 6, 2);
  const auto zones = [&](bool random, double first, double second, double third) -> std::vector<LevelZone> {
    const RotatingTerm a = on_clock(drive(oscillating, 6e-7, f + 2e3, first), 0, random);
    const RotatingTerm b = on_clock(drive(positive, 4e-7, 7e3, second), 7, random);
    const RotatingTerm c = on_clock(along_z(drive(oscillating, 4e-7, f, third)), 1, random);
    return {{0, 0.03, field, a}, {0.03, 0.07, field, b}, {0.07, 0.1, field, c}, {0.1, 0.12, field, b}};
  };
  const Eigen::MatrixXd p = test::probabilities(DrivenLevels(spins, zones(true, 0.3, 0.9, 1.3), slowest), s);
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(8, 8);
  constexpr int steps[] = {4, 17, 4};
  const auto at = [&](int i, int j, int k) {
    return test::probabilities(
        DrivenLevels(spins, zones(false, two_pi * i / steps[0], two_pi * j / steps[1], two_pi * k / steps[2]),
                     slowest),
        s);
  };
  for (int i = 0; i < steps[0]; ++i)
    for (int j = 0; j < steps[1]; ++j)
      for (int k = 0; k < steps[2]; ++k) mean += at(i, j, k) / (steps[0] * steps[1] * steps[2]);
  EXPECT_LT(difference(p, mean), 5e-11);
  for (const Eigen::MatrixXd& other : {at(1, 0, 0), at(0, 1, 0), at(0, 0, 1)})
    EXPECT_GT(difference(other, at(0, 0, 0)), 0.02);
  EXPECT_GT(difference(p, at(0, 0, 0)), 0.05);
  expect_doubly_stochastic(p);
}

TEST(DrivenLevels, WithOneClockDoNotDependOnItsStartPhaseAndWithTwoAlikeOnlyOnTheirDifference) {
  const CoupledSpins spins = small_atom(3, 1);
  const auto p = [&](bool random, double phase, int second_clock) {
    const RotatingTerm a = on_clock(drive(positive, 4e-7, 56e3, phase), 0, random);
    const RotatingTerm b = on_clock(drive(positive, 4e-7, 56e3, 0), second_clock, random);
    return test::probabilities(DrivenLevels(spins, {{0, 0.03, 8e-6, a}, {0.05, 0.08, 8e-6, b}}, slowest),
                               3e-3);
  };
  EXPECT_LT(difference(p(true, 0.4, 0), p(false, 0.4, 0)), 2e-11);
  EXPECT_LT(difference(p(false, 0.4, 1), p(false, 0.4, 0)), 1e-9);  // one frequency, two locked clocks
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(8, 8);
  for (int i = 0; i < 16; ++i) mean += p(false, two_pi * i / 16, 1) / 16;
  EXPECT_LT(difference(p(true, 0.4, 1), mean), 2e-11);
  EXPECT_GT(difference(mean, p(false, 0.4, 0)), 0.01);
}

TEST(DrivenLevels, WithoutAnythingToDriveThemStayWhereTheyAre) {
  const CoupledSpins spins = small_atom(3, 1);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(8, 8);
  const auto p = [&](std::vector<LevelZone> zones) {
    return test::probabilities(DrivenLevels(spins, std::move(zones), slowest), 2e-3);
  };
  EXPECT_EQ(p({}), one);
  EXPECT_EQ(p({{0, 1, 1e-5, std::nullopt}}), one);
  EXPECT_EQ(p({{0, 1, 1e-5, drive(positive, 0, 1e5)}}), one);
  EXPECT_EQ(p({{0, 1, 1e-5, drive(oscillating, 0, 0)}}), one);
  EXPECT_EQ(p({{1, 1, 1e-5, drive(positive, 1e-6, 1e5)}}), one);
  EXPECT_EQ(test::probabilities(
                DrivenLevels(CoupledSpins{}, {{0, 1, 1e-5, drive(positive, 1e-6, 1e5)}}, slowest), 2e-3),
            Eigen::MatrixXd::Identity(1, 1));
  const DrivenLevels standing(spins, {{0, 0.1, 1e-5, drive(positive, 1e-6, 1e5)}}, slowest);
  EXPECT_LT(difference(test::probabilities(standing, 0), one), 2e-11);
}

TEST(DrivenLevels, AreFiniteAtZeroFieldAndZeroFrequencyAndTellWhatTheyNeglect) {
  const CoupledSpins spins = small_atom(3, 1);
  for (const int sense : {positive, negative, oscillating})
    for (const double frequency : {0.0, 5e4, 4e5})
      for (const double field : {0.0, 1e-5})
        for (const Shape shape : {Shape::rectangular, Shape::half_sine, Shape::gaussian}) {
          RotatingTerm d = drive(sense, 1e-7, frequency);
          d.envelope.shape = shape;  // with a length and a sigma of zero
          expect_doubly_stochastic(
              test::probabilities(DrivenLevels(spins, {{0, 0.1, field, d}}, slowest), 2e-3));
        }
  EXPECT_TRUE(
      std::isinf(DrivenLevels(half(), {{0, 0.1, 0, drive(oscillating, 1e-7, 0)}}, slowest).neglected()));
  // Resonant in no field: a spin follows a slowly turning field like any other
  const DrivenLevels turned(half(), {{0, 0.1, 0, drive(positive, 1e-8, 0)}}, slowest);
  EXPECT_NEAR(test::probabilities(turned, 2e-3)(0, 1), rabi(two_pi * 280, 0, 2e-4), 2e-11);
}

TEST(DrivenLevels, RefuseZonesThatOverlapAndClocksWithTwoFrequencies) {
  const auto build = [](std::vector<LevelZone> zones) { DrivenLevels(half(), std::move(zones), slowest); };
  EXPECT_THROW(build({{0, 1, 0, std::nullopt}, {0.5, 2, 0, std::nullopt}}), std::invalid_argument);
  EXPECT_THROW(build({{1, 0, 0, std::nullopt}}), std::invalid_argument);
  EXPECT_THROW(build({{0, 1, 0, drive(positive, 1e-7, 1e5)}, {1, 2, 0, drive(positive, 1e-7, 2e5)}}),
               std::invalid_argument);
}

}  // namespace
}  // namespace rabiline::driven_limits_test
