#include "spin/levels.hpp"
#include "spin/hamiltonian.hpp"

#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdlib>

#include "core/constants.hpp"
#include "spin/atoms.hpp"

namespace rabiline::levels_test {
namespace {

using constants::bohr_magneton;
using constants::planck;

// Rb-87 in 5P3/2: A = 84.7185 MHz, B = 12.4965 MHz (D. Steck, Rubidium 87 D Line Data).
HyperfineAtom excited_rubidium() {
  HyperfineAtom atom = *find_atom("Rb-87");
  atom.twice_j = 3;
  atom.hyperfine_constant = 84.7185e6;
  atom.quadrupole_constant = 12.4965e6;
  atom.g_j = 1.3362;
  return atom;
}

/// Any I and J, with every term of the Hamiltonian at work.
HyperfineAtom any_atom(int twice_i, int twice_j) {
  return {.name = "X",
          .twice_i = twice_i,
          .twice_j = twice_j,
          .hyperfine_constant = -70e6,
          .quadrupole_constant = 31e6,
          .g_j = 1.4,
          .g_i = -7e-4,
          .source = "none"};
}

/// H/h as a complex matrix of all levels at once, in the basis |m_I, m_J> (the other order), from the atom's
/// constants, diagonalised by GSL: E/h in hertz from below.
std::vector<double> by_gsl(const HyperfineAtom& atom, double field) {
  using Complex = std::complex<double>;
  const double i = atom.twice_i / 2.0, j = atom.twice_j / 2.0;
  const int ni = atom.twice_i + 1, nj = atom.twice_j + 1, n = ni * nj;
  // <m+1|S_+|m> = sqrt(s(s+1) - m(m+1)); axis 0, 1, 2 is x, y, z; index 0 is m = -s
  const auto element = [](double s, int axis, int a, int b) -> Complex {
    const double m_a = -s + a, m_b = -s + b;
    if (axis == 2) return a == b ? m_a : 0;
    if (std::abs(a - b) != 1) return 0;
    const double low = std::min(m_a, m_b), ladder = std::sqrt(s * (s + 1) - low * (low + 1));
    return axis == 0 ? Complex(ladder / 2) : Complex(0, a > b ? -ladder / 2 : ladder / 2);
  };
  Eigen::MatrixXcd dot = Eigen::MatrixXcd::Zero(n, n);
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c)
      for (int axis = 0; axis < 3; ++axis)
        dot(r, c) += element(i, axis, r / nj, c / nj) * element(j, axis, r % nj, c % nj);
  Eigen::MatrixXcd h = atom.hyperfine_constant * dot;
  if (i >= 1 && j >= 1)
    h += atom.quadrupole_constant / (2 * i * (2 * i - 1) * j * (2 * j - 1)) *
         (3 * dot * dot + 1.5 * dot - i * (i + 1) * j * (j + 1) * Eigen::MatrixXcd::Identity(n, n));
  for (int k = 0; k < n; ++k)
    h(k, k) += bohr_magneton / planck * field * (atom.g_i * (-i + k / nj) + atom.g_j * (-j + k % nj));

  gsl_matrix_complex* matrix = gsl_matrix_complex_alloc(n, n);
  gsl_vector* values = gsl_vector_alloc(n);
  gsl_eigen_herm_workspace* workspace = gsl_eigen_herm_alloc(n);
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c)
      gsl_matrix_complex_set(matrix, r, c, gsl_complex_rect(h(r, c).real(), h(r, c).imag()));
  gsl_eigen_herm(matrix, values, workspace);
  std::vector<double> out(n);
  for (int k = 0; k < n; ++k) out[k] = gsl_vector_get(values, k);
  std::ranges::sort(out);
  gsl_eigen_herm_free(workspace);
  gsl_vector_free(values);
  gsl_matrix_complex_free(matrix);
  return out;
}

/// The largest distance of two spectra, as a fraction of the larger one's width.
double distance(const HyperfineAtom& atom, const HyperfineAtom& reference, double field) {
  std::vector<double> energies = levels_at(coupled_spins(atom), field).energy;
  std::ranges::sort(energies);
  const std::vector<double> expected = by_gsl(reference, field);
  double worst = 0;
  for (std::size_t k = 0; k < expected.size(); ++k)
    worst = std::max(worst, std::abs(energies[k] / planck - expected[k]));
  return worst / (expected.back() - expected.front());
}

TEST(Levels, HaveTheSpectrumOfTheWholeComplexMatrixForEverySpin) {
  for (int twice_i = 1; twice_i <= 9; ++twice_i)
    for (int twice_j = 1; twice_j <= 3; ++twice_j)
      for (const double field : {0.0, 1e-4, 7e-3, 0.2, 3.0})
        EXPECT_LT(distance(any_atom(twice_i, twice_j), any_atom(twice_i, twice_j), field), 1e-13)
            << "2I = " << twice_i << ", 2J = " << twice_j << ", B = " << field;
}

TEST(Levels, HaveAnotherSpectrumWhenAnyConstantIsOnePercentOff) {
  const HyperfineAtom atom = any_atom(5, 3);
  for (double HyperfineAtom::*constant :
       {&HyperfineAtom::hyperfine_constant, &HyperfineAtom::quadrupole_constant, &HyperfineAtom::g_j,
        &HyperfineAtom::g_i}) {
    HyperfineAtom off = atom;
    off.*constant *= 1.01;
    EXPECT_GT(distance(off, atom, 0.01), 1e-8);
  }
}

TEST(Levels, OfExcitedRubidiumHaveItsPublishedHyperfineStructure) {
  const Levels levels = levels_at(coupled_spins(excited_rubidium()), 0);
  const double expected[] = {-302.0738e6, -229.8518e6, -72.9112e6, 193.7407e6};  // F = 0 ... 3, Steck
  for (int f = 0; f <= 3; ++f) {
    const int n = *find_weak_field_level(levels.labels, 2 * f, 0);
    EXPECT_NEAR(levels.energy[n] / planck, expected[f], 200);
  }
}

TEST(Levels, HaveMomentsThatAreTheSlopesOfTheirEnergies) {
  for (const HyperfineAtom& atom : {*find_atom("Cs-133"), excited_rubidium(), any_atom(9, 3)}) {
    const CoupledSpins spins = coupled_spins(atom);
    for (const double field : {2e-3, 0.04, 0.7}) {
      const double step = 1e-3 * field;
      const Levels levels = levels_at(spins, field);
      const auto energy = [&](double steps, std::size_t n) {
        return levels_at(spins, field + steps * step).energy[n];
      };
      for (std::size_t n = 0; n < levels.energy.size(); ++n) {
        const double slope =
            (8 * (energy(1, n) - energy(-1, n)) - (energy(2, n) - energy(-2, n))) / (12 * step);
        EXPECT_NEAR(levels.moment[n], -slope, 1e-8 * bohr_magneton) << atom.name << " level " << n;
      }
    }
  }
}

TEST(Levels, HaveStatesThatSolveTheHamiltonianAndAreOrthonormal) {
  for (const double field : {0.0, 1e-3, 0.3}) {
    const CoupledSpins spins = coupled_spins(excited_rubidium());
    const Levels levels = levels_at(spins, field);
    const Eigen::VectorXd energy =
        Eigen::Map<const Eigen::VectorXd>(levels.energy.data(), spins.levels()) / planck;
    const Eigen::MatrixXd h = hamiltonian(spins, field);
    EXPECT_LT((h * levels.states - levels.states * energy.asDiagonal()).norm(), 1e-13 * h.norm());
    EXPECT_LT((levels.states.transpose() * levels.states -
               Eigen::MatrixXd::Identity(spins.levels(), spins.levels()))
                  .norm(),
              1e-13);
  }
}

TEST(Levels, HaveTheLandeFactorOfFAtZeroField) {
  const HyperfineAtom atom = excited_rubidium();
  const Levels levels = levels_at(coupled_spins(atom), 0);
  for (std::size_t n = 0; n < levels.labels.size(); ++n) {
    const double f = levels.labels[n].twice_f / 2.0, m = levels.labels[n].twice_m / 2.0;
    if (f == 0) {
      EXPECT_NEAR(levels.moment[n], 0, 1e-12 * bohr_magneton);
      continue;
    }
    // I = J = 3/2: F shares itself out equally between them
    const double g_f = (atom.g_j + atom.g_i) / 2;
    EXPECT_NEAR(levels.moment[n], -g_f * bohr_magneton * m, 1e-12 * bohr_magneton);
  }
}

TEST(Levels, WithoutCouplingAreThoseOfTwoFreeSpinsAndMeetAtZeroField) {
  HyperfineAtom atom = any_atom(3, 3);
  atom.hyperfine_constant = atom.quadrupole_constant = 0;
  for (const double field : {0.0, 0.4}) {
    const Levels levels = levels_at(coupled_spins(atom), field);
    for (std::size_t n = 0; n < levels.labels.size(); ++n) {
      const LevelLabel& label = levels.labels[n];
      const double moment = -bohr_magneton * (atom.g_j * label.twice_m_j + atom.g_i * label.twice_m_i) / 2;
      EXPECT_NEAR(levels.moment[n], moment, 1e-14 * bohr_magneton);
      EXPECT_NEAR(levels.energy[n], -moment * field, 1e-14 * bohr_magneton);
    }
  }
}

TEST(Levels, OfOneSpinAloneAreThoseOfAPointMoment) {
  for (const bool nuclear : {false, true}) {
    const HyperfineAtom atom = nuclear ? any_atom(5, 0) : any_atom(0, 3);
    const double g = nuclear ? atom.g_i : atom.g_j;
    const Levels levels = levels_at(coupled_spins(atom), 0.25);
    EXPECT_EQ(levels.labels.size(), nuclear ? 6u : 4u);
    for (std::size_t n = 0; n < levels.labels.size(); ++n)
      EXPECT_NEAR(levels.energy[n], g * bohr_magneton * 0.25 * levels.labels[n].twice_m / 2,
                  1e-15 * bohr_magneton);
  }
}

}  // namespace
}  // namespace rabiline::levels_test
