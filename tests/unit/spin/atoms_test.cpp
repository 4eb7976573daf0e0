#include "spin/atoms.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.hpp"
#include "particle/species.hpp"
#include "spin/levels.hpp"

namespace rabiline::atoms_test {
namespace {

/// How much weaker the nucleus is in the atom than bare, by the library of species: 1 - mu(atom)/mu(bare).
double shielding(const HyperfineAtom& atom) {
  const Species& species = *find_species(atom.name);
  // mu = gamma hbar I = -g_I' mu_B I
  return 1 - -atom.g_i * constants::bohr_magneton / (species.gyromagnetic_ratio * constants::hbar);
}

TEST(AtomLibrary, HasNucleiOfTheRightSignAndSizeSlightlyShieldedByTheElectrons) {
  EXPECT_EQ(atom_library().size(), 12u);
  for (const HyperfineAtom& atom : atom_library()) {
    EXPECT_EQ(atom.twice_i, find_species(atom.name)->spin.twice) << atom.name;
    // Cs: 0.73 %; K-39's bare moment is known to 8e-5
    EXPECT_GT(shielding(atom), -1e-4) << atom.name;
    EXPECT_LT(shielding(atom), 8e-3) << atom.name;
    EXPECT_FALSE(atom.source.empty());
  }
  // alpha^2/3 = 17.75e-6 in hydrogen (Lamb)
  EXPECT_NEAR(shielding(*find_atom("H")), 17.75e-6, 0.1e-6);
  EXPECT_NEAR(shielding(*find_atom("D")), 17.75e-6, 0.1e-6);
}

TEST(AtomLibrary, HasHyperfineConstantsOfTheSignOfTheNuclearMoment) {
  for (const HyperfineAtom& atom : atom_library())
    EXPECT_GT(atom.hyperfine_constant * find_species(atom.name)->gyromagnetic_ratio, 0) << atom.name;
}

// For one electron shell A is proportional to mu_I / I up to the hyperfine anomaly, below 0.5 % in these
// pairs.
TEST(AtomLibrary, HasIsotopesWhoseHyperfineConstantsFollowTheirNuclearMoments) {
  const auto ratio = [](const char* a, const char* b) {
    const HyperfineAtom &one = *find_atom(a), &other = *find_atom(b);
    return one.hyperfine_constant / other.hyperfine_constant / (one.g_i / other.g_i);
  };
  EXPECT_NEAR(ratio("H", "D"), 1, 5e-3);
  EXPECT_NEAR(ratio("Li-6", "Li-7"), 1, 5e-3);
  EXPECT_NEAR(ratio("K-39", "K-41"), 1, 5e-3);
  EXPECT_NEAR(ratio("Rb-85", "Rb-87"), 1, 5e-3);
  EXPECT_NEAR(ratio("Ag-107", "Ag-109"), 1, 5e-3);
}

TEST(AtomLibrary, ReproducesTheSplittingsInMegahertz) {
  const struct {
    const char* name;
    double splitting;
  } rows[] = {{"H", 1420.405751768},   {"D", 327.384352522},     {"Li-6", 228.205261},
              {"Li-7", 803.504087},    {"Na-23", 1771.626129},   {"K-39", 461.719720},
              {"K-41", 254.013870},    {"Rb-85", 3035.732439},   {"Rb-87", 6834.682610904},
              {"Cs-133", 9192.631770}, {"Ag-107", -1712.512111}, {"Ag-109", -1976.932075}};
  for (const auto& [name, splitting] : rows) {
    const HyperfineAtom& atom = *find_atom(name);
    const Levels levels = levels_at(coupled_spins(atom), 0);
    const int upper = *find_weak_field_level(levels.labels, atom.twice_i + 1, atom.twice_i - 1);
    const int lower = *find_weak_field_level(levels.labels, atom.twice_i - 1, atom.twice_i - 1);
    EXPECT_NEAR(transition_frequency(levels, lower, upper) / 1e6, splitting, 1e-12 * std::abs(splitting));
  }
}

// S states: g_J is that of the free electron, 2.00231930436 (CODATA 2022), to 2e-5 in hydrogen (relativistic
// binding, alpha^2/3) and to 1.2e-4 in caesium.
TEST(AtomLibrary, HasTheElectronsGFactorUpToBinding) {
  for (const HyperfineAtom& atom : atom_library())
    EXPECT_NEAR(atom.g_j / 2.00231930436, 1, 1.2e-4) << atom.name;
  for (const char* name : {"H", "D"})
    EXPECT_NEAR(1 - find_atom(name)->g_j / 2.00231930436, 17.71e-6, 0.03e-6) << name;
  // g_J(H)/g_J(D) = 1 + 7.22(3)e-9 (Walther et al. 1972)
  EXPECT_NEAR(find_atom("H")->g_j / find_atom("D")->g_j - 1, 7.22e-9, 2.6e-8 / 2);
}

TEST(AtomLibrary, DoesNotKnowOtherNames) { EXPECT_EQ(find_atom("Cs-134"), nullptr); }

}  // namespace
}  // namespace rabiline::atoms_test
