#include "particle/species.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/constants.hpp"

namespace rabiline::species_test {
namespace {

using namespace constants;

const Species& species(std::string_view name) {
  const Species* found = find_species(name);
  if (!found) throw std::runtime_error(std::string(name));
  return *found;
}
double mass_in_u(std::string_view name) { return species(name).mass / atomic_mass; }
double megahertz(std::string_view name) { return species(name).gyromagnetic_ratio / two_pi / 1e6; }
double moment(std::string_view name, double magneton) {  // mu = gamma hbar I
  const Species& s = species(name);
  return s.gyromagnetic_ratio * hbar * s.spin.value() / magneton;
}

/// gamma/2pi as tables of magnetic resonance print it, signs from the moments; the spin from the books.
struct Known {
  const char* name;
  int twice_spin;
  double megahertz;
  double half_digit;  // of the last one printed
};
constexpr Known known[] = {
    {"neutron", 1, -29.16469, 5e-6},   {"proton", 1, 42.5775, 5e-5},  {"deuteron", 2, 6.53590, 5e-6},
    {"electron", 1, -28024.951, 5e-4}, {"muon+", 1, 135.53881, 5e-6}, {"muon-", 1, -135.53881, 5e-6},
    {"H", 1, 42.5775, 5e-5},           {"D", 2, 6.53590, 5e-6},       {"He-3", 1, -32.43604, 6e-6},
    {"He-3 gas", 1, -32.43410, 5e-6},  {"Li-6", 2, 6.26613, 5e-6},    {"Li-7", 3, 16.54828, 5e-6},
    {"F-19", 1, 40.07758, 5e-6},       {"Na-23", 3, 11.26885, 5e-6},  {"K-39", 3, 1.98934, 5e-6},
    {"K-41", 3, 1.09191, 5e-6},        {"Rb-85", 5, 4.12529, 5e-6},   {"Rb-87", 3, 13.9814, 5e-5},
    {"Ag-107", 1, -1.7314, 5e-5},      {"Ag-109", 1, -1.9904, 5e-5},  {"Xe-129", 1, -11.8604, 5e-5},
    {"Cs-133", 7, 5.62335, 5e-6},      {"Hg-199", 1, 7.7123, 5e-5},
};

TEST(SpeciesLibrary, HasEverySpeciesOnceWithItsSpinSignAndRatio) {
  ASSERT_EQ(species_library().size(), std::size(known));
  for (const Known& k : known) {
    EXPECT_EQ(species(k.name).spin.twice, k.twice_spin) << k.name;
    EXPECT_NEAR(megahertz(k.name), k.megahertz, k.half_digit) << k.name;
  }
  EXPECT_EQ(find_species("neutrino"), nullptr);
}

TEST(SpeciesLibrary, HasTheMomentsThatItsSourcesPrint) {
  EXPECT_NEAR(moment("neutron", nuclear_magneton), -1.91304276, 1e-8);
  EXPECT_NEAR(moment("proton", nuclear_magneton), 2.79284734463, 1e-9);
  EXPECT_NEAR(moment("deuteron", nuclear_magneton), 0.8574382335, 1e-10);
  EXPECT_NEAR(moment("electron", bohr_magneton), -1.00115965218, 1e-9);
  EXPECT_NEAR(moment("muon-", bohr_magneton), -4.84197048e-3, 1e-11);
  EXPECT_NEAR(moment("He-3", bohr_magneton), -1.15874098083e-3, 1e-12);
  EXPECT_NEAR(moment("He-3 gas", bohr_magneton), -1.15867149457e-3, 1e-12);
  EXPECT_NEAR(moment("Li-7", nuclear_magneton), 3.256427, 1e-6);
}

TEST(SpeciesLibrary, AgreesWithTheRatiosOfMomentsThatWereMeasuredDirectly) {
  // CODATA 2022; for atoms of the gas shielded nuclei: S. Afach et al., Phys. Lett. B 739, 128 (2014),
  // gamma_n/gamma_Hg = 3.8424574.
  EXPECT_NEAR(megahertz("neutron") / megahertz("proton"), -0.68497935, 1e-8);
  EXPECT_NEAR(moment("deuteron", 1) / moment("proton", 1), 0.30701220930, 1e-10);
  EXPECT_NEAR(moment("muon-", 1) / moment("proton", 1), -3.183345146, 1e-9);
  EXPECT_NEAR(moment("He-3", 1) * (1 - 5.9967029e-5) / moment("proton", 1), -0.76176657721, 1e-9);
  EXPECT_NEAR(moment("He-3 gas", 1) / moment("proton", 1), -0.76176657721, 1e-9);
  EXPECT_NEAR(megahertz("He-3 gas") / megahertz("neutron"), 1.112102, 1e-6);  // the critical dressing of both
  EXPECT_NEAR(megahertz("neutron") / megahertz("Hg-199") / (1 - 0.0158), -3.8424574, 1e-3);
}

TEST(SpeciesLibrary, GivesIsotopesOfAnElementRatiosOfTheirHyperfineSplittings) {
  // delta nu is proportional to gamma (2I+1) but for the anomaly of the nuclei's size, at most 0.6 %.
  const auto ratio = [](const char* a, const char* b) {
    return megahertz(a) * (species(a).spin.twice + 1) / (megahertz(b) * (species(b).spin.twice + 1));
  };
  EXPECT_NEAR(ratio("H", "D") / (1420.405751768 / 327.384352522), 1, 1e-3);
  EXPECT_NEAR(ratio("Li-7", "Li-6") / (803.504087 / 228.205261), 1, 2e-4);
  EXPECT_NEAR(ratio("K-39", "K-41") / (461.719720 / 254.013870), 1, 3e-3);
  EXPECT_NEAR(ratio("Rb-87", "Rb-85") / (6834.682611 / 3035.732439), 1, 4e-3);
  EXPECT_NEAR(ratio("Ag-109", "Ag-107") / (1976.932075 / 1712.512111), 1, 5e-3);
}

TEST(SpeciesLibrary, GivesHalfSpinsToNucleiWithAnOddNumberOfNucleons) {
  for (const Species& s : species_library()) {
    const std::size_t hyphen = s.name.find('-');
    if (hyphen == std::string::npos || hyphen + 1 == s.name.size()) continue;
    const int nucleons = std::stoi(s.name.substr(hyphen + 1));
    EXPECT_EQ(s.spin.twice % 2, nucleons % 2) << s.name;
    EXPECT_NEAR(mass_in_u(s.name), nucleons, 0.11) << s.name;
  }
}

TEST(SpeciesLibrary, ChargesTheFreeParticlesAndLeavesAtomsNeutral) {
  for (const Species& s : species_library()) {
    const bool positive = s.name == "proton" || s.name == "deuteron" || s.name == "muon+";
    const bool negative = s.name == "electron" || s.name == "muon-";
    EXPECT_EQ(s.charge, (positive - negative) * elementary_charge) << s.name;
    const bool free_particle = positive || negative || s.name == "neutron";
    EXPECT_EQ(s.left_out.empty(), free_particle || s.name == "He-3 gas") << s.name;
  }
}

TEST(SpeciesLibrary, StatesTheUncertaintyAndTheSourceOfEachConstant) {
  for (const Species& s : species_library()) {
    EXPECT_NE(s.source, "") << s.name;
    EXPECT_GT(s.mass_uncertainty, 0) << s.name;
    EXPECT_LT(s.mass_uncertainty, 3e-8 * s.mass) << s.name;
    EXPECT_GT(s.gyromagnetic_ratio_uncertainty, 0) << s.name;
    EXPECT_LT(s.gyromagnetic_ratio_uncertainty, 2e-4 * std::abs(s.gyromagnetic_ratio)) << s.name;
  }
  EXPECT_DOUBLE_EQ(species("neutron").mass_uncertainty, 85e-38);
  EXPECT_DOUBLE_EQ(species("neutron").gyromagnetic_ratio_uncertainty, two_pi * 6.9);
  EXPECT_DOUBLE_EQ(species("Li-6").mass_uncertainty, 1.55e-9 * atomic_mass);
  EXPECT_NEAR(species("Rb-87").gyromagnetic_ratio_uncertainty / species("Rb-87").gyromagnetic_ratio,
              0.00012 / 2.75131, 1e-12);
}

TEST(GFactor, GivesTheGyromagneticRatioOfAChargeWithItsOwnMass) {
  // CODATA 2022; tables give electron and muon- a negative g, which here their charge stands for.
  const auto gamma = [](std::string_view name, double g) {
    return gyromagnetic_ratio(GFactor{g}, species(name).charge, species(name).mass);
  };
  EXPECT_NEAR(gamma("proton", 5.5856946893) / species("proton").gyromagnetic_ratio, 1, 1e-9);
  EXPECT_NEAR(gamma("electron", 2.00231930436092) / species("electron").gyromagnetic_ratio, 1, 1e-9);
  EXPECT_NEAR(gamma("muon-", 2.00233184123) / species("muon-").gyromagnetic_ratio, 1, 1e-7);
  EXPECT_EQ(gyromagnetic_ratio(GyromagneticRatio{-5}, 1, 1), -5);
}

TEST(SpeciesLibrary, GivesAtomsTheMassOfTheirPartsLessTheirBinding) {
  EXPECT_NEAR(mass_in_u("H") / (mass_in_u("proton") + mass_in_u("electron")), 1 - 13.6 / 938.8e6, 1e-9);
  EXPECT_NEAR(mass_in_u("D") / (mass_in_u("deuteron") + mass_in_u("electron")), 1 - 13.6 / 1876.1e6, 1e-9);
  // CODATA 2022: relative atomic mass of the helion; 79 eV bind its two electrons.
  EXPECT_NEAR(mass_in_u("He-3"), 3.014932246932 + 2 * mass_in_u("electron") - 79.0 / 931.494e6, 1e-9);
  EXPECT_NEAR(species("muon+").mass / species("electron").mass, 206.7682827, 5e-6);
}

double mass_of_energy(double electronvolts) {
  return electronvolts * elementary_charge / (speed_of_light * speed_of_light);
}

// f_HFS(2S) is an eighth of f_HFS(1S) but for relativity and radiation: 8 f(2S) - f(1S) = 48.923(54) kHz in H
// and 11.280(56) kHz in D (Kolachevsky et al. 2009, 2004).
TEST(MetastableSpecies, HaveAnEighthOfTheSplittingOfTheGroundStateAndNearlyItsMoments) {
  const struct {
    const char *excited, *ground;
    double splitting, above;
  } rows[] = {{"H(2S) atom", "H atom", 177556834.3, 48.923e3}, {"D(2S) atom", "D atom", 40924454, 11.28e3}};
  for (const auto& row : rows) {
    const Structure &excited = *species(row.excited).structure, &ground = *species(row.ground).structure;
    const double of_coupling = excited.i.value() + 0.5;
    EXPECT_NEAR(excited.coupling * of_coupling, row.splitting, 0.1);
    EXPECT_NEAR((8 * excited.coupling - ground.coupling) * of_coupling, row.above, 100) << row.excited;
    // g_J = g_e (1 - alpha^2/(3 n^2)): 3/4 of the 17.75e-6 that 1S lacks are there again.
    EXPECT_NEAR(excited.g_j / ground.g_j - 1, 0.75 * 17.75e-6, 0.1e-6);
    EXPECT_NEAR(excited.g_i / ground.g_i - 1, 0.75 * 17.75e-6, 0.1e-6);
    EXPECT_NEAR((species(row.excited).mass - species(row.ground).mass) / mass_of_energy(10.2), 1, 1e-3);
  }
}

TEST(MetastableSpecies, OfHeliumHasThreeLevelsOfAnElectronicSpinOfOne) {
  const Species& helium = species("He-4(2S)");
  EXPECT_EQ(helium.levels(), 3);
  EXPECT_EQ(helium.structure->i.twice, 0);
  EXPECT_NEAR(helium.structure->g_j, 2.0022372, 2e-7);
  EXPECT_NEAR(helium.mass / atomic_mass, 4.002603275, 1e-9);  // 4.002603254 u and 19.82 eV
  EXPECT_NEAR(helium.gyromagnetic_ratio / two_pi / 1e9, -28.0238, 1e-4);
}

TEST(Antihydrogen, HasTheMomentsOfHydrogenWithOppositeSignsAndItsCoupling) {
  const Structure &anti = *species("antihydrogen").structure, &hydrogen = *species("H atom").structure;
  EXPECT_EQ(anti.coupling, hydrogen.coupling);
  EXPECT_EQ(anti.g_j, -hydrogen.g_j);
  EXPECT_EQ(anti.g_i, -hydrogen.g_i);
  EXPECT_EQ(species("antihydrogen").mass, species("H").mass);
  EXPECT_GT(species("antihydrogen").gyromagnetic_ratio, 0);  // the positron's moment is along its spin
}

TEST(NaturalMixtures, ShareAllParticlesAmongTheIsotopesOfAnElement) {
  for (const Mixture& mixture : natural_mixtures()) {
    double sum = 0;
    for (const Component& component : mixture.components) sum += component.fraction;
    EXPECT_NEAR(sum, 1, 1e-12) << mixture.name;
    for (const Component& component : mixture.components)
      EXPECT_EQ(component.species.structure.has_value(), mixture.name.ends_with(" atom")) << mixture.name;
  }
  // Their mean is the element's atomic weight: Li 6.94, K 39.098, Rb 85.468, Ag 107.868.
  const auto weight = [](std::string_view name) {
    double mass = 0;
    for (const Component& component : find_mixture(name)->components)
      mass += component.fraction * component.species.mass / atomic_mass;
    return mass;
  };
  EXPECT_NEAR(weight("natural Li"), 6.94, 3e-3);
  EXPECT_NEAR(weight("natural K atom"), 39.0983, 2e-4);
  EXPECT_NEAR(weight("natural Rb"), 85.4678, 4e-4);
  EXPECT_NEAR(weight("natural Ag atom"), 107.8682, 2e-4);
  EXPECT_EQ(find_mixture("natural Cs"), nullptr);
}

}  // namespace
}  // namespace rabiline::species_test
