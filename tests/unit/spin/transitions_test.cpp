#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "core/constants.hpp"
#include "spin/atoms.hpp"
#include "spin/levels.hpp"

namespace rabiline::transitions_test {
namespace {

using constants::bohr_magneton;
using constants::planck;

TEST(TransitionFrequency, OfTheHydrogenLineIsItsHyperfineSplittingAndChangesSignWithItsDirection) {
  const Levels levels = levels_at(coupled_spins(*find_atom("H")), 0);
  EXPECT_NEAR(transition_frequency(levels, 3, 1), 1420.405751768e6, 1e-3);
  EXPECT_EQ(transition_frequency(levels, 1, 3), -transition_frequency(levels, 3, 1));
}

TEST(DipoleMatrices, AreHermitianWithTheEffectiveMomentsAlongTheFieldOnTheDiagonal) {
  const CoupledSpins spins = coupled_spins(*find_atom("Na-23"));
  const Levels levels = levels_at(spins, 0.02);
  const auto mu = dipole_matrices(spins, levels);
  for (const Eigen::MatrixXcd& axis : mu) EXPECT_LT((axis - axis.adjoint()).norm(), 1e-14 * bohr_magneton);
  for (int n = 0; n < spins.levels(); ++n) {
    EXPECT_NEAR(mu[2](n, n).real(), levels.moment[n], 1e-14 * bohr_magneton);
    EXPECT_NEAR(std::abs(mu[0](n, n)) + std::abs(mu[1](n, n)), 0, 1e-14 * bohr_magneton);
  }
}

TEST(DipoleMatrices, KeepMAlongTheFieldAndChangeItByOneAcross) {
  const CoupledSpins spins = coupled_spins(*find_atom("Rb-85"));
  const Levels levels = levels_at(spins, 0.05);
  const auto mu = dipole_matrices(spins, levels);
  for (int a = 0; a < spins.levels(); ++a)
    for (int b = 0; b < spins.levels(); ++b) {
      const int change = std::abs(levels.labels[a].twice_m - levels.labels[b].twice_m) / 2;
      if (change != 0) {
        EXPECT_LT(std::abs(mu[2](a, b)), 1e-15 * bohr_magneton);
      }
      if (change != 1) {
        EXPECT_LT(std::abs(mu[0](a, b)) + std::abs(mu[1](a, b)), 1e-15 * bohr_magneton);
      }
    }
}

// At B = 0, |1,0> and |0,0> of H are (|+-> +- |-+>)/sqrt 2, so <1,0|mu_z|0,0> = -(g_J - g_I')/2 mu_B and
// |<1,1|mu_x|0,0>| = (g_J - g_I') mu_B / (2 sqrt 2).
TEST(DipoleMatrices, OfHydrogenAtZeroFieldAreThoseOfTheSingletAndTheTriplet) {
  const HyperfineAtom& atom = *find_atom("H");
  const CoupledSpins spins = coupled_spins(atom);
  const auto mu = dipole_matrices(spins, levels_at(spins, 0));
  const double difference = (atom.g_j - atom.g_i) * bohr_magneton;
  EXPECT_NEAR(mu[2](1, 3).real(), -difference / 2, 1e-12 * difference);
  EXPECT_NEAR(std::abs(mu[0](0, 3)), difference / std::sqrt(8), 1e-12 * difference);
  EXPECT_NEAR(std::abs(mu[1](0, 3)), difference / std::sqrt(8), 1e-12 * difference);
  // mu_+ = mu_x + i mu_y raises m_F, so it has no element from (1,1) to (0,0)
  const std::complex<double> i(0, 1);
  EXPECT_LT(std::abs(mu[0](3, 0) + i * mu[1](3, 0)), 1e-14 * difference);
  EXPECT_GT(std::abs(mu[0](0, 3) + i * mu[1](0, 3)), 0.5 * difference);
}

TEST(DipoleMatrices, HaveTheSameSumOfSquaresAlongEveryAxisAtEveryField) {
  const CoupledSpins spins = coupled_spins(*find_atom("Cs-133"));
  // Trace of mu_a^2, J_a^2 having the mean J(J+1)/3 over its 2J+1 states: 1/4 for J = 1/2, 21/4 for I = 7/2
  const double expected =
      16 * planck * planck * (spins.zeeman_j * spins.zeeman_j / 4 + spins.zeeman_i * spins.zeeman_i * 21 / 4);
  for (const double field : {0.0, 0.1, 2.0})
    for (const Eigen::MatrixXcd& axis : dipole_matrices(spins, levels_at(spins, field)))
      EXPECT_NEAR(axis.squaredNorm() / expected, 1, 1e-13);
}

TEST(ThermalPopulations, FollowBoltzmannAndAddUpToOne) {
  const Levels levels = levels_at(coupled_spins(*find_atom("H")), 0);
  const std::vector<double> shares = thermal_populations(levels, 0.07);
  EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), 1, 1e-15);
  // h 1420.4 MHz / k = 68.17 mK above the singlet
  const double ratio = std::exp(-planck * 1420.405751768e6 / (constants::boltzmann * 0.07));
  EXPECT_NEAR(shares[0] / shares[3], ratio, 1e-12);
  EXPECT_NEAR(ratio, std::exp(-0.06817 / 0.07), 1e-4);
}

TEST(ThermalPopulations, AreEqualInAHotOvenAndAllInTheLowestLevelInTheCold) {
  const Levels levels = levels_at(coupled_spins(*find_atom("Ag-107")), 0.1);
  for (const double share : thermal_populations(levels, 1e9)) EXPECT_NEAR(share, 0.25, 1e-9);
  for (const double share : thermal_populations(levels, std::numeric_limits<double>::infinity()))
    EXPECT_EQ(share, 0.25);
  const std::vector<double> cold = thermal_populations(levels, 1e-6);
  const auto lowest = std::ranges::min_element(levels.energy) - levels.energy.begin();
  EXPECT_EQ(cold[lowest], 1);
}

}  // namespace
}  // namespace rabiline::transitions_test
