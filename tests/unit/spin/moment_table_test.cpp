// The table of moments against diagonalisation and Breit and Rabi, from 0 to 20 T.
#include "spin/moment_table.hpp"
#include "particle/species.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "spin/breit_rabi.hpp"
#include "spin/levels.hpp"
#include "unit/transport/readers.hpp"

namespace rabiline::moment_table_test {
namespace {

/// From 1 uT to 20 T in equal ratios, and next to nothing: at 0 the size of a field cannot fall further.
std::vector<double> fields() {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> exponent(-6, std::log10(20.0));
  std::vector<double> out{1e-12, 20};
  for (int i = 0; i < 300; ++i) out.push_back(std::pow(10, exponent(random)));
  return out;
}

void expect_table(const CoupledSpins& spins, const char* name) {
  const MomentTable table(spins);
  EXPECT_LE(table.error(), 1e-9 * table.largest()) << name;
  EXPECT_LE(table.coefficients().size() * sizeof(double), 640U << 10) << name;
  for (const double field : fields()) {
    const Levels exact = levels_at(spins, field);
    for (const Isa isa : test::instruction_sets()) {
      const Eigen::VectorXd found = test::moments(table, field, isa);
      for (int n = 0; n < spins.levels(); ++n)
        ASSERT_NEAR(found(n), exact.moment[static_cast<std::size_t>(n)], 2e-9 * table.largest())
            << name << ", level " << n << " at " << field << " T";
    }
  }
}

TEST(MomentTable, HoldsTheMomentsOfAtomsAtAnyField) {
  for (const char* name : {"H", "D", "Na-23", "K-39", "Rb-87", "Cs-133", "Ag-107"})
    expect_table(coupled_spins(*find_atom(name)), name);
}

TEST(MomentTable, HoldsThoseOfLargerSpinsAndOfAMolecule) {
  CoupledSpins excited{
      .twice_i = 3, .twice_j = 3, .coupling = 94.7e6, .zeeman_i = -1.4e7, .zeeman_j = 1.87e10};
  add_quadrupole(excited, 2e6);
  expect_table(excited, "J = 3/2");
  expect_table({.twice_i = 9, .twice_j = 3, .coupling = -50e6, .zeeman_i = 1e6, .zeeman_j = 1.8e10},
               "40 levels");
  expect_table(coupled_spins(*find_species("ortho-H2")->structure), "ortho-H2");
}

TEST(MomentTable, AgreesWithBreitAndRabi) {
  const HyperfineAtom& atom = *find_atom("Cs-133");
  const MomentTable table(coupled_spins(atom));
  const std::vector<LevelLabel> labels = level_labels(coupled_spins(atom));
  for (const double field : fields()) {
    const Eigen::VectorXd found = test::moments(table, field);
    for (std::size_t n = 0; n < labels.size(); ++n)
      ASSERT_NEAR(found(static_cast<Eigen::Index>(n)),
                  breit_rabi(atom, labels[n].twice_f, labels[n].twice_m, field).moment,
                  2e-9 * table.largest());
  }
}

TEST(MomentTable, OfUncoupledSpinsIsOneCellOfConstants) {
  const MomentTable table({.twice_i = 1, .twice_j = 1, .zeeman_i = -4e7, .zeeman_j = 2.8e10});
  EXPECT_EQ(table.cells(), 1);
  EXPECT_EQ(test::moments(table, 0.1), test::moments(table, 1e-9));
}

}  // namespace
}  // namespace rabiline::moment_table_test
