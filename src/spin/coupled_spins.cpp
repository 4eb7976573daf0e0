#include "spin/coupled_spins.hpp"

#include "spin/hamiltonian.hpp"

#include "spin/angular_momentum.hpp"

namespace rabiline {

double scalar_product(const CoupledSpins& spins, int twice_f) {
  const int i = spins.twice_i, j = spins.twice_j;
  return (twice_f * (twice_f + 2) - i * (i + 2) - j * (j + 2)) / 8.0;
}

double zero_field_energy(const CoupledSpins& spins, int twice_f) {
  const double x = scalar_product(spins, twice_f);
  return (spins.coupling_squared * x + spins.coupling) * x + spins.offset;
}

Eigen::MatrixXd scalar_product_matrix(const CoupledSpins& spins) {
  const AngularMomentum i = angular_momentum(spins.twice_i), j = angular_momentum(spins.twice_j);
  return kronecker(j.x, i.x) + kronecker(j.z, i.z) - kronecker(j.i_times_y, i.i_times_y);
}

Eigen::MatrixXd hamiltonian(const CoupledSpins& spins, double field) {
  const Eigen::MatrixXd i_dot_j = scalar_product_matrix(spins);
  Eigen::MatrixXd h = spins.coupling * i_dot_j + spins.coupling_squared * (i_dot_j * i_dot_j);
  for (int k = 0; k < spins.levels(); ++k)
    h(k, k) += spins.offset +
               field * (spins.zeeman_i * spins.twice_m_i(k) + spins.zeeman_j * spins.twice_m_j(k)) / 2;
  return h;
}

void add_quadrupole(CoupledSpins& spins, double weight) {
  const int i = spins.twice_i, j = spins.twice_j;
  spins.coupling_squared += 3 * weight;
  spins.coupling += 1.5 * weight;
  spins.offset -= weight * (i * (i + 2)) * (j * (j + 2)) / 16;
}

}  // namespace rabiline
