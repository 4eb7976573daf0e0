// What is asked of levels once they are known: frequencies, dipole elements, populations, vanishing moments.
#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
#include "spin/angular_momentum.hpp"
#include "spin/levels.hpp"

namespace rabiline {
namespace {

struct MomentOfLevel {
  const CoupledSpins& spins;
  int level;
  double at(double field) const { return levels_at(spins, field).moment[level]; }
};

/// The root of the moment between two fields where its signs differ, by Brent's method.
double zero_between(const MomentOfLevel& moment, double from, double to) {
  MomentOfLevel copy = moment;
  gsl_function function{[](double field, void* m) { return static_cast<const MomentOfLevel*>(m)->at(field); },
                        &copy};
  const std::unique_ptr<gsl_root_fsolver, decltype(&gsl_root_fsolver_free)> solver(
      gsl_root_fsolver_alloc(gsl_root_fsolver_brent), &gsl_root_fsolver_free);
  gsl_root_fsolver_set(solver.get(), &function, from, to);
  for (int i = 0; i < 200; ++i) {
    gsl_root_fsolver_iterate(solver.get());
    if (gsl_root_test_interval(gsl_root_fsolver_x_lower(solver.get()), gsl_root_fsolver_x_upper(solver.get()),
                               0, 1e-14) == GSL_SUCCESS)
      break;
  }
  return gsl_root_fsolver_root(solver.get());
}

}  // namespace

double transition_frequency(const Levels& levels, int from, int to) {
  return (levels.energy[to] - levels.energy[from]) / constants::planck;
}

std::array<Eigen::MatrixXcd, 3> dipole_matrices(const CoupledSpins& spins, const Levels& levels) {
  const AngularMomentum i = angular_momentum(spins.twice_i), j = angular_momentum(spins.twice_j);
  const auto between_levels = [&](const Eigen::MatrixXd& of_i,
                                  const Eigen::MatrixXd& of_j) -> Eigen::MatrixXd {
    const Eigen::MatrixXd one_i = Eigen::MatrixXd::Identity(of_i.rows(), of_i.cols());
    const Eigen::MatrixXd one_j = Eigen::MatrixXd::Identity(of_j.rows(), of_j.cols());
    const Eigen::MatrixXd moment = -constants::planck * (spins.zeeman_i * kronecker(one_j, of_i) +
                                                         spins.zeeman_j * kronecker(of_j, one_i));
    return levels.states.transpose() * moment * levels.states;
  };
  return {between_levels(i.x, j.x).cast<std::complex<double>>(),
          std::complex<double>(0, -1) * between_levels(i.i_times_y, j.i_times_y),
          between_levels(i.z, j.z).cast<std::complex<double>>()};
}

std::vector<double> thermal_populations(const Levels& levels, double temperature) {
  const double lowest = *std::ranges::min_element(levels.energy);
  std::vector<double> shares;
  double sum = 0;
  for (const double energy : levels.energy) {
    shares.push_back(portable::exp(-(energy - lowest) / (constants::boltzmann * temperature)));
    sum += shares.back();
  }
  for (double& share : shares) share /= sum;
  return shares;
}

std::vector<double> zero_moment_fields(const CoupledSpins& spins, int level, double from, double to) {
  constexpr int steps = 400;
  const MomentOfLevel moment{spins, level};
  std::vector<double> zeros;
  double left = from, left_moment = moment.at(from);
  for (int k = 1; k <= steps; ++k) {
    const double right = k == steps ? to : from * portable::pow(to / from, k / double{steps});
    const double right_moment = moment.at(right);
    if (left_moment == 0)
      zeros.push_back(left);
    else if (left_moment * right_moment < 0)
      zeros.push_back(zero_between(moment, left, right));
    left = right;
    left_moment = right_moment;
  }
  if (left_moment == 0) zeros.push_back(left);
  return zeros;
}

}  // namespace rabiline
