#include "spin/angular_momentum.hpp"

#include <cmath>

namespace rabiline {

AngularMomentum angular_momentum(int twice_j) {
  const int levels = twice_j + 1;
  Eigen::MatrixXd raise = Eigen::MatrixXd::Zero(levels, levels), z = raise;
  for (int k = 0; k < levels; ++k) {
    const int twice_m = twice_j - 2 * k;
    z(k, k) = twice_m / 2.0;
    // 4 (j(j+1) - m(m+1)), in whole numbers
    if (k > 0) raise(k - 1, k) = std::sqrt(twice_j * (twice_j + 2) - twice_m * (twice_m + 2)) / 2;
  }
  return {(raise + raise.transpose()) / 2, (raise - raise.transpose()) / 2, z};
}

Eigen::MatrixXd kronecker(const Eigen::MatrixXd& slow, const Eigen::MatrixXd& fast) {
  Eigen::MatrixXd out(slow.rows() * fast.rows(), slow.cols() * fast.cols());
  for (Eigen::Index r = 0; r < slow.rows(); ++r)
    for (Eigen::Index c = 0; c < slow.cols(); ++c)
      out.block(r * fast.rows(), c * fast.cols(), fast.rows(), fast.cols()) = slow(r, c) * fast;
  return out;
}

}  // namespace rabiline
