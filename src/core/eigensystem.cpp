#include "core/eigensystem.hpp"

#include <Eigen/Eigenvalues>

namespace rabiline {

template <class Matrix>
Eigensystem<Matrix> eigensystem_of(const Matrix& matrix) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

template Eigensystem<Eigen::MatrixXd> eigensystem_of(const Eigen::MatrixXd&);
template Eigensystem<Eigen::MatrixXcd> eigensystem_of(const Eigen::MatrixXcd&);

}  // namespace rabiline
