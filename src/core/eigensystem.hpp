#pragma once
// Eigenvalues and eigenvectors of what equals its own adjoint.
#include <Eigen/Core>

namespace rabiline {

/// Values ascend; the columns of `vectors`, of length 1, are theirs.
template <class Matrix>
struct Eigensystem {
  Eigen::VectorXd values;
  Matrix vectors;
};

/// Of a symmetric or Hermitian matrix, whose lower triangle is read: Eigen::MatrixXd or Eigen::MatrixXcd.
/// Eigen's solver, which takes long to compile, is compiled here alone.
template <class Matrix>
Eigensystem<Matrix> eigensystem_of(const Matrix&);

}  // namespace rabiline
