#pragma once
// Matrices of two coupled spins.
#include <Eigen/Core>

#include "spin/coupled_spins.hpp"

namespace rabiline {

/// I.J in the basis |m_J, m_I>: I_x J_x + I_z J_z - (i I_y)(i J_y), a real matrix.
Eigen::MatrixXd scalar_product_matrix(const CoupledSpins& spins);
/// H/h in hertz in the basis |m_J, m_I>, at the field B in tesla.
Eigen::MatrixXd hamiltonian(const CoupledSpins& spins, double field);

}  // namespace rabiline
