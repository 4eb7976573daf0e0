#include "core/eigensystem.hpp"

#include <gtest/gtest.h>

#include <complex>

namespace rabiline::eigensystem_test {

TEST(Eigensystem, DiagonalisesASymmetricMatrixWithValuesThatAscend) {
  Eigen::MatrixXd h(3, 3);
  h << 2, 1, 0, 1, 2, 1, 0, 1, 2;
  const auto own = eigensystem_of(h);
  EXPECT_NEAR(own.values(0), 2 - std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(own.values(1), 2, 1e-15);
  EXPECT_NEAR(own.values(2), 2 + std::sqrt(2.0), 1e-15);
  EXPECT_LT((h * own.vectors - own.vectors * own.values.asDiagonal()).norm(), 1e-14);
  EXPECT_LT((own.vectors.transpose() * own.vectors - Eigen::MatrixXd::Identity(3, 3)).norm(), 1e-14);
}

TEST(Eigensystem, DiagonalisesAHermitianMatrix) {
  const std::complex<double> i(0, 1);
  Eigen::MatrixXcd h(2, 2);
  h << 0, -i, i, 0;  // Pauli's second
  const auto own = eigensystem_of(h);
  EXPECT_NEAR(own.values(0), -1, 1e-15);
  EXPECT_NEAR(own.values(1), 1, 1e-15);
  EXPECT_LT((h * own.vectors - own.vectors * own.values.asDiagonal()).norm(), 1e-14);
}

}  // namespace rabiline::eigensystem_test
