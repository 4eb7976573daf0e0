#include "spin/majorana.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "unit/transport/readers.hpp"

namespace rabiline::majorana_test {
namespace {

using test::instruction_sets;
using test::probabilities;
using test::shares;

/// |<m'| exp(-i beta I_y) |m>|^2 with I_y as a matrix: I_y = (I_+ - I_-)/2i, so the exponential is real.
double by_matrix_exponential(int twice_spin, int from, int to, double beta) {
  const int d = twice_spin + 1;
  const double spin = twice_spin / 2.0;
  Eigen::MatrixXd generator = Eigen::MatrixXd::Zero(d, d);
  for (int k = 1; k < d; ++k) {
    const double m = spin - k;  // raising m to m + 1
    const double raise = std::sqrt(spin * (spin + 1) - m * (m + 1));
    generator(k - 1, k) = -raise / 2;
    generator(k, k - 1) = raise / 2;
  }
  const Eigen::MatrixXd rotation = (beta * generator).exp();
  return rotation(to, from) * rotation(to, from);
}

TEST(MajoranaTable, EqualsTheExponentialOfIyForEverySpinLevelAndAngle) {
  for (int twice = 1; twice <= 9; ++twice) {
    const MajoranaTable table = majorana_table(twice);
    for (const double beta : {0.0, 0.3, 1.1, 1.5707963267948966, 2.9, 3.141592653589793})
      for (const Isa isa : instruction_sets()) {
        const double flip = std::pow(std::sin(beta / 2), 2);
        const Eigen::MatrixXd p = probabilities(table, flip, isa), weights = shares(table, flip, isa);
        for (int from = 0; from <= twice; ++from)
          for (int to = 0; to <= twice; ++to) {
            const double expected = by_matrix_exponential(twice, from, to, beta);
            EXPECT_NEAR(p(from, to), expected, 1e-10)
                << "2I = " << twice << ", " << from << " -> " << to << ", beta = " << beta;
            EXPECT_NEAR(weights(from, to), expected, 1e-10);
          }
      }
  }
}

TEST(MajoranaTable, SharesOutEverythingFromEveryLevel) {
  const Eigen::MatrixXd p = probabilities(majorana_table(7), 0.37), weights = shares(majorana_table(7), 0.37);
  for (int from = 0; from <= 7; ++from) {
    EXPECT_NEAR(p.row(from).sum(), 1, 1e-11);
    EXPECT_EQ(weights.row(from).sum(), 1);
  }
}

TEST(MajoranaTable, GivesThePublishedSharesOfSpinThreeHalvesAtOneQuarter) {
  const Eigen::MatrixXd p = probabilities(majorana_table(3), 0.25);
  const double expected[] = {.421875, .421875, .140625, .015625};
  for (int to = 0; to < 4; ++to) EXPECT_NEAR(p(0, to), expected[to], 1e-14);
}

}  // namespace
}  // namespace rabiline::majorana_test
