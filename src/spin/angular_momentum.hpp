#pragma once
// Matrices of one angular momentum j in units of hbar.
#include <Eigen/Core>

namespace rabiline {

/// Cartesian components of an angular momentum j, in units of hbar, in the basis |m> with m = j, j-1, ... -j
/// along +z. With Condon and Shortley's phases x and z are real and y is imaginary: y holds i J_y, which is
/// real and antisymmetric, so that nothing here needs complex numbers.
///   <m+1| J_+ |m> = sqrt(j(j+1) - m(m+1)),  J_x = (J_+ + J_-)/2,  i J_y = (J_+ - J_-)/2
struct AngularMomentum {
  Eigen::MatrixXd x, i_times_y, z;
};

AngularMomentum angular_momentum(int twice_j);

/// |j m> of the first spin next to |j m> of the second: the first index runs slowly.
Eigen::MatrixXd kronecker(const Eigen::MatrixXd& slow, const Eigen::MatrixXd& fast);

}  // namespace rabiline
