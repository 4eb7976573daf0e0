#include "spin/transition_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "spin/atoms.hpp"
#include "spin/levels.hpp"
#include "unit/transport/readers.hpp"

namespace rabiline {
namespace {

/// Two fields that turn, apart, and levels of sodium in them.
DrivenLevels sodium(double off = 800) {
  const CoupledSpins spins = coupled_spins(*find_atom("Na-23"));
  const double field = 2e-5;
  RotatingTerm drive;
  drive.amplitude = 2.5e-7;
  drive.oscillator.frequency = transition_frequency(levels_at(spins, field), 1, 0) + off;
  RotatingTerm second = drive;
  second.oscillator.phase = 0.7;
  return {spins, {{0, 0.1, field, drive}, {0.1, 0.3, field, std::nullopt}, {0.3, 0.4, field, second}}, 4e-3};
}

double worst_of(const TransitionTable& table, const DrivenLevels& driven, double from, double to) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> slowness(from, to);
  double worst = 0;
  for (int k = 0; k < 300; ++k) {
    // some close to the ends, where the polynomials are not centred
    const double s = k % 10 == 0 ? from + (to - from) / table.points * k / 300 : slowness(random);
    const Eigen::MatrixXd exact = driven.probabilities(s);
    for (const Isa isa : test::instruction_sets())
      worst = std::max(worst, (test::probabilities(table, s, isa) - exact).cwiseAbs().maxCoeff());
  }
  return worst;
}

TEST(TransitionTable, StaysBelowItsBoundEverywhere) {
  const DrivenLevels driven = sodium();
  for (const double tolerance : {1e-3, 1e-5, 1e-6}) {
    const TransitionTable table = tabulate(driven, 1e-3, 4e-3, tolerance, 1 << 16);
    EXPECT_LT(table.error, tolerance);
    EXPECT_LT(worst_of(table, driven, 1e-3, 4e-3), table.error);
  }
}

TEST(TransitionTable, TellsItsErrorWhenItMayNotHaveEnoughPoints) {
  const DrivenLevels driven = sodium();
  const TransitionTable table = tabulate(driven, 1e-3, 4e-3, 1e-6, 40);
  EXPECT_LE(table.points, 40);
  EXPECT_GT(table.error, 1e-6);
  EXPECT_LT(worst_of(table, driven, 1e-3, 4e-3), table.error);
}

TEST(TransitionTable, OfOneSlownessIsExactThereToSinglePrecision) {
  const DrivenLevels driven = sodium();
  const TransitionTable table = tabulate(driven, 2e-3, 2e-3);
  EXPECT_EQ(table.points, 1);
  EXPECT_EQ(table.step, 0);
  EXPECT_LT(table.error, 1e-7);
  EXPECT_LT((test::probabilities(table, 2e-3) - driven.probabilities(2e-3)).cwiseAbs().maxCoeff(),
            table.error);
}

TEST(TransitionTable, KeepsWhatALevelCanGoToAndHoldsItsEndsOutsideItsRange) {
  const CoupledSpins spins = coupled_spins(*find_atom("H"));
  RotatingTerm drive;
  drive.amplitude = 1e-7;
  drive.oscillator.frequency = transition_frequency(levels_at(spins, 1e-5), 1, 0);
  const DrivenLevels driven(spins, {{0, 0.1, 1e-5, drive}}, 4e-3);
  const TransitionTable table = tabulate(driven, 1e-3, 4e-3, 1e-4);
  // F = 1 keeps to itself but for what the other level takes, and rows add up.
  ASSERT_EQ(table.begin.size(), 5U);
  EXPECT_EQ(table.values.size(), static_cast<std::size_t>(table.points * table.row()) + 8);
  for (int point = 0; point < table.points; ++point)
    for (int from = 0; from < 4; ++from) {
      double sum = 0;
      for (int t = table.begin[static_cast<std::size_t>(from)];
           t < table.begin[static_cast<std::size_t>(from) + 1]; ++t)
        sum += table.at(point, t);
      EXPECT_NEAR(sum, 1, 1e-6);
    }
  for (const Isa isa : test::instruction_sets()) {
    EXPECT_EQ(test::probabilities(table, 5e-4, isa), test::probabilities(table, 1e-3, isa));
    EXPECT_EQ(test::probabilities(table, 9e-3, isa), test::probabilities(table, 4e-3, isa));
  }
  EXPECT_NEAR(table.first + table.step * (table.points - 1), 4e-3, 1e-15);
}

}  // namespace
}  // namespace rabiline
