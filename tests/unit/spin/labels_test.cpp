#include <gtest/gtest.h>

#include <cmath>

#include "particle/species.hpp"
#include "spin/angular_momentum.hpp"
#include "spin/atoms.hpp"
#include "spin/hamiltonian.hpp"
#include "spin/levels.hpp"

namespace rabiline::labels_test {
namespace {

/// Atoms with a normal, an inverted and a J = 3/2 structure, and a molecule.
std::vector<CoupledSpins> systems() {
  HyperfineAtom quartet{.name = "X",
                        .twice_i = 5,
                        .twice_j = 3,
                        .hyperfine_constant = -25e6,
                        .quadrupole_constant = 26e6,
                        .g_j = 1.33,
                        .g_i = -3e-4,
                        .source = "none"};
  return {coupled_spins(*find_atom("Na-23")), coupled_spins(*find_atom("Cs-133")),
          coupled_spins(*find_atom("Ag-107")), coupled_spins(quartet),
          coupled_spins(*find_species("ortho-H2")->structure)};
}

TEST(LevelLabels, AreNumberedFromTheLargestFAndTheLargestMDown) {
  const std::vector<LevelLabel> hydrogen = level_labels(coupled_spins(*find_atom("H")));
  const std::vector<LevelLabel> expected = {{2, 2, 1, 1}, {2, 0, 1, -1}, {2, -2, -1, -1}, {0, 0, -1, 1}};
  EXPECT_EQ(hydrogen, expected);
}

TEST(LevelLabels, OfAnInvertedStructureLeadTheUpperFToTheLowerElectronState) {
  const std::vector<LevelLabel> silver = level_labels(coupled_spins(*find_atom("Ag-107")));
  const std::vector<LevelLabel> expected = {{2, 2, 1, 1}, {2, 0, -1, 1}, {2, -2, -1, -1}, {0, 0, 1, -1}};
  EXPECT_EQ(silver, expected);
}

TEST(LevelLabels, AreTheSameAtEveryFieldAndNameEveryLevelOnceInBothWays) {
  for (const CoupledSpins& spins : systems()) {
    const std::vector<LevelLabel> labels = level_labels(spins);
    for (const double field : {0.0, 1e-3, 5.0}) EXPECT_EQ(levels_at(spins, field).labels, labels);
    for (int n = 0; n < spins.levels(); ++n) {
      EXPECT_EQ(labels[n].twice_m, labels[n].twice_m_j + labels[n].twice_m_i);
      EXPECT_EQ(find_weak_field_level(labels, labels[n].twice_f, labels[n].twice_m), n);
      EXPECT_EQ(find_strong_field_level(labels, labels[n].twice_m_j, labels[n].twice_m_i), n);
    }
    EXPECT_EQ(find_weak_field_level(labels, 99, 1), std::nullopt);
    EXPECT_EQ(find_strong_field_level(labels, 99, 1), std::nullopt);
  }
}

TEST(LevelLabels, NameTheTotalAngularMomentumAtZeroField) {
  for (const CoupledSpins& spins : systems()) {
    const Levels levels = levels_at(spins, 0);
    const int i = spins.twice_i, j = spins.twice_j;
    const Eigen::MatrixXd f_squared =
        2 * scalar_product_matrix(spins) +
        (i * (i + 2) + j * (j + 2)) / 4.0 * Eigen::MatrixXd::Identity(spins.levels(), spins.levels());
    for (int n = 0; n < spins.levels(); ++n) {
      const Eigen::VectorXd state = levels.states.col(n);
      const int f = levels.labels[n].twice_f;
      EXPECT_NEAR(state.dot(f_squared * state), f * (f + 2) / 4.0, 1e-11);
    }
  }
}

TEST(LevelLabels, NameTheProductStateInAStrongField) {
  for (const CoupledSpins& spins : systems()) {
    const Levels levels = levels_at(spins, 3000);
    for (int n = 0; n < spins.levels(); ++n) {
      const LevelLabel& label = levels.labels[n];
      const int product = spins.product_index(label.twice_m_j, label.twice_m_i);
      EXPECT_GT(std::abs(levels.states(product, n)), 0.999);
    }
  }
}

TEST(LevelLabels, FollowTheStatesContinuouslyFromZeroToAStrongField) {
  for (const CoupledSpins& spins : systems()) {
    const bool keeps_sign = spins.coupling_squared == 0;
    Levels before = levels_at(spins, 0);
    for (double field = 1e-7; field < 100; field *= 1.02) {
      const Levels after = levels_at(spins, field);
      for (int n = 0; n < spins.levels(); ++n) {
        const double overlap = before.states.col(n).dot(after.states.col(n));
        ASSERT_GT(keeps_sign ? overlap : std::abs(overlap), 0.98) << "level " << n << ", B = " << field;
      }
      before = after;
    }
  }
}

}  // namespace
}  // namespace rabiline::labels_test
