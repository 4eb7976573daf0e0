// Atoms and molecules that fly in the levels of two coupled spins.
#include <fmt/format.h>

#include <vector>

#include "core/constants.hpp"
#include "particle/species.hpp"
#include "spin/atoms.hpp"

namespace rabiline {
namespace {

using constants::bohr_magneton;
using constants::hbar;
using constants::planck;

HyperfineAtom as_atom(const Structure& s) {
  return {.name = {},
          .twice_i = s.i.twice,
          .twice_j = s.j.twice,
          .hyperfine_constant = s.coupling,
          .quadrupole_constant = s.quadrupole,
          .g_j = s.g_j,
          .g_i = s.g_i,
          .source = {}};
}

/// The mass is that of the library's species of the same name, which is that of the neutral atom.
Species atom_with_levels(const HyperfineAtom& atom) {
  const Species& point = *find_species(atom.name);
  Species species = with_levels(fmt::format("{} atom", atom.name), point.mass,
                                {.i = {atom.twice_i},
                                 .j = {atom.twice_j},
                                 .coupling = atom.hyperfine_constant,
                                 .g_j = atom.g_j,
                                 .g_i = atom.g_i},
                                fmt::format("{}; AME2020 (mass)", atom.source));
  species.mass_uncertainty = point.mass_uncertainty;
  return species;
}

/// A homonuclear molecule in its rotational state J = 1 with total nuclear spin I = 1:
///   H/h = -gamma_n B I_z - b B J_z - c I.J + d [3 (I.J)^2 + (3/2) I.J - I(I+1) J(J+1)]
/// gamma_n and b in Hz/T, c and d in Hz; B of the structure is 2d where I = J = 1.
Species molecule(const char* name, const char* half, double gamma_n, double b, double c, double d,
                 const char* source) {
  constexpr double magneton = bohr_magneton / planck;  // [Hz/T]
  return with_levels(name, 2 * find_species(half)->mass,
                     {.i = {2},
                      .j = {2},
                      .coupling = -c,
                      .quadrupole = 2 * d,
                      .g_j = -b / magneton,
                      .g_i = -gamma_n / magneton},
                     source);
}

/// [kg] of an excitation energy in eV.
double mass_of_excitation(double energy) {
  return energy * constants::elementary_charge / (constants::speed_of_light * constants::speed_of_light);
}

// What binds an electron in the level nS of hydrogen makes both its moment and the field of the nucleus
// smaller by alpha^2/(3 n^2) (G. Breit, Nature 122, 649 (1928); W. Lamb, Phys. Rev. 60, 817 (1941)): in 2S a
// quarter of what it does in 1S. Recoil and radiation change that by less than 1e-8.
constexpr double binding_in_2s = 7.2973525643e-3 * 7.2973525643e-3 / 12, g_electron = 2.00231930436092;

/// H(2S) or D(2S), with the splitting between F = I+1/2 and F = I-1/2 [Hz] and the bare moment [nuclear
/// magnetons].
Species metastable_hydrogen(const char* of, HalfInteger i, double splitting, double moment,
                            const char* source) {
  const Species& ground = *find_species(of);
  constexpr double excitation = 10.1988;  // [eV] 2S above 1S
  const double g_i = -moment / i.value() * constants::nuclear_magneton / bohr_magneton * (1 - binding_in_2s);
  Species species =
      with_levels(fmt::format("{}(2S) atom", of), ground.mass + mass_of_excitation(excitation),
                  {.i = i,
                   .j = {1},
                   .coupling = splitting / (i.value() + 0.5),
                   .g_j = g_electron * (1 - binding_in_2s),
                   .g_i = g_i},
                  fmt::format("{} (splitting), CODATA 2022 (moments; both smaller by alpha^2/12 in "
                              "the atom), AME2020 (mass)",
                              source));
  species.mass_uncertainty = ground.mass_uncertainty;
  return species;
}

/// Both moments have the signs opposite to those in hydrogen, and their product, the coupling, has the same.
Species antihydrogen() {
  const Species& hydrogen = *find_species("H");
  Structure structure = *atom_with_levels(*find_atom("H")).structure;
  structure.g_j = -structure.g_j;
  structure.g_i = -structure.g_i;
  Species species = with_levels("antihydrogen", hydrogen.mass, structure,
                                "the constants of hydrogen, both moments with opposite signs (CPT)");
  species.mass_uncertainty = hydrogen.mass_uncertainty;
  return species;
}

/// Without a nuclear spin: three levels of the two electrons' spin of 1.
Species metastable_helium() {
  constexpr double g_j_of_hydrogen = 2.00228386, excitation = 19.8196;  // [eV] 2 3S1 above the ground state
  Species species =
      with_levels("He-4(2S)", 4.00260325413 * constants::atomic_mass + mass_of_excitation(excitation),
                  {.i = {0}, .j = {2}, .g_j = g_j_of_hydrogen * (1 - 23.3e-6)},
                  "C. Drake, V. Hughes, A. Lurio, J. White, Phys. Rev. 112, 1627 (1958) (g_J over that of "
                  "hydrogen, 1 - 23.3(8)e-6); AME2020 (mass)");
  species.mass_uncertainty = 1.6e-10 * constants::atomic_mass;
  return species;
}

}  // namespace

CoupledSpins coupled_spins(const Structure& structure) { return coupled_spins(as_atom(structure)); }

/// mu = -g_J mu_B J, so gamma = -g_J mu_B/hbar.
Species with_levels(std::string name, double mass, const Structure& structure, std::string source) {
  Species species;
  species.name = std::move(name);
  species.mass = mass;
  species.source = std::move(source);
  species.spin = structure.j;
  species.gyromagnetic_ratio = -structure.g_j * bohr_magneton / hbar;
  species.structure = structure;
  return species;
}

std::span<const Species> species_with_levels() {
  static const std::vector<Species> library = [] {
    std::vector<Species> out;
    for (const HyperfineAtom& atom : atom_library()) out.push_back(atom_with_levels(atom));
    // c and d of H2: N. Harrick, R. Barnes, P. Bray, N. Ramsey, Phys. Rev. 90, 260 (1953); of D2, where d
    // holds the quadrupole interaction too: R. Code, N. Ramsey, Phys. Rev. A 4, 1945 (1971). All as they are
    // quoted for them, b rounded to 0.3 %; shielding of the nuclei is left out.
    out.push_back(
        molecule("ortho-H2", "H", 42.577478461e6, 6.71e6, 113.904e3, 57.671e3,
                 "c, d and b from general knowledge after Harrick et al. 1953; CODATA 2022 (proton)"));
    out.push_back(
        molecule("para-D2", "D", 6.53569e6, 3.37e6, 8.768e3, 25.2414e3,
                 "c, d and b from general knowledge after Code and Ramsey 1971; CODATA 2022 (deuteron)"));
    out.push_back(metastable_hydrogen("H", {1}, 177556834.3, 2.7928473446,
                                      "N. Kolachevsky et al., Phys. Rev. Lett. 102, 213002 (2009)"));
    out.push_back(metastable_hydrogen("D", {2}, 40924454, 0.8574382335,
                                      "N. Kolachevsky et al., Phys. Rev. A 70, 062503 (2004)"));
    out.push_back(antihydrogen());
    out.push_back(metastable_helium());
    return out;
  }();
  return library;
}

std::span<const Mixture> natural_mixtures() {
  // J. Meija et al., Pure Appl. Chem. 88, 293 (2016), representative abundances, where the sources on Earth
  // do not differ by more: of H and Li those of M. Berglund and M. Wieser, Pure Appl. Chem. 83, 397 (2011).
  // K-40, 1.17e-4 of potassium, is left out. Each is divided by the sum.
  static const std::vector<Mixture> library = [] {
    struct Isotope {
      const char* name;
      double abundance;
    };
    const auto mixture = [](const char* symbol, const char* ending, const Isotope& a, const Isotope& b) {
      const double sum = a.abundance + b.abundance;
      return Mixture{fmt::format("natural {}{}", symbol, ending),
                     {{*find_species(fmt::format("{}{}", a.name, ending)), a.abundance / sum},
                      {*find_species(fmt::format("{}{}", b.name, ending)), b.abundance / sum}}};
    };
    std::vector<Mixture> out;
    for (const char* ending : {"", " atom"}) {
      out.push_back(mixture("H", ending, {"H", 0.999885}, {"D", 0.000115}));
      out.push_back(mixture("Li", ending, {"Li-6", 0.0759}, {"Li-7", 0.9241}));
      out.push_back(mixture("K", ending, {"K-39", 0.932581}, {"K-41", 0.067302}));
      out.push_back(mixture("Rb", ending, {"Rb-85", 0.7217}, {"Rb-87", 0.2783}));
      out.push_back(mixture("Ag", ending, {"Ag-107", 0.51839}, {"Ag-109", 0.48161}));
    }
    return out;
  }();
  return library;
}

const Mixture* find_mixture(std::string_view name) {
  for (const Mixture& mixture : natural_mixtures())
    if (mixture.name == name) return &mixture;
  return nullptr;
}

}  // namespace rabiline
