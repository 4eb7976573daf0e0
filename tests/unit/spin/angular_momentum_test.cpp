#include "spin/angular_momentum.hpp"

#include <gtest/gtest.h>

namespace rabiline::angular_momentum_test {
namespace {

TEST(AngularMomentum, ObeysItsCommutatorsAndHasTheLengthOfJ) {
  for (int twice = 0; twice <= 9; ++twice) {
    const AngularMomentum j = angular_momentum(twice);
    const Eigen::Index d = twice + 1;
    const Eigen::MatrixXd& y = j.i_times_y;
    // [J_x, J_y] = i J_z, [J_y, J_z] = i J_x, [J_z, J_x] = i J_y with y = i J_y
    EXPECT_LT((j.x * y - y * j.x + j.z).norm(), 1e-13);
    EXPECT_LT((y * j.z - j.z * y + j.x).norm(), 1e-13);
    EXPECT_LT((j.z * j.x - j.x * j.z - y).norm(), 1e-13);
    const Eigen::MatrixXd square = j.x * j.x - y * y + j.z * j.z;
    EXPECT_LT((square - twice * (twice + 2) / 4.0 * Eigen::MatrixXd::Identity(d, d)).norm(), 1e-12);
  }
}

TEST(AngularMomentum, OfOneHalfIsHalfOfPaulisMatricesWithTheUpperStateFirst) {
  const AngularMomentum s = angular_momentum(1);
  EXPECT_EQ(s.z(0, 0), 0.5);
  EXPECT_EQ(s.z(1, 1), -0.5);
  EXPECT_EQ(s.x(0, 1), 0.5);
  EXPECT_EQ(s.i_times_y(0, 1), 0.5);  // i sigma_y / 2
  EXPECT_EQ(s.i_times_y(1, 0), -0.5);
}

}  // namespace
}  // namespace rabiline::angular_momentum_test
