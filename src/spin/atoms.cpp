#include "spin/atoms.hpp"

#include <vector>

#include "core/constants.hpp"

namespace rabiline {
namespace {

/// A row of the library: the splitting between F = I+1/2 and F = I-1/2 is A (I + 1/2), negative if inverted.
struct Entry {
  std::string_view name;
  int twice_i;
  double splitting, splitting_uncertainty;  // [MHz]
  double g_j, g_j_uncertainty;
  double g_i, g_i_uncertainty;
  std::string_view source;
};

constexpr std::string_view arimondo = "E. Arimondo, M. Inguscio, P. Violino, Rev. Mod. Phys. 49, 31 (1977)";
constexpr std::string_view rubidium_87 =
    "S. Bize et al., Europhys. Lett. 45, 558 (1999) (splitting), Arimondo et al. 1977 (g factors)";
constexpr std::string_view caesium = "the SI second (splitting), Arimondo et al. 1977 (g factors)";

// H: g_J = g_e (1 - 17.709(13)e-6), J. Tiedeman, H. Robinson, Phys. Rev. Lett. 39, 602 (1977), and
// g_J/g_I' = -658.210706(6) of the atom itself, P. Winkler et al., Phys. Rev. A 5, 83 (1972).
constexpr double g_j_h = 2.00228386, g_i_h = -g_j_h / 658.210706;
constexpr std::string_view hydrogen =
    "hydrogen maser (splitting), Tiedeman and Robinson 1977 (g_J), Winkler et al. 1972 (g_J/g_I')";

// D: g_J(H)/g_J(D) = 1 + 7.22(3)e-9, F. Walther, W. Phillips, D. Kleppner, Phys. Rev. Lett. 28, 1159 (1972).
// The bare deuteron's 0.8574382335(22) mu_N (CODATA 2022) is shielded by alpha^2/3 = 17.75e-6 (W. Lamb 1941).
// Higher orders change that by about 1e-8 of the moment.
constexpr double alpha = 7.2973525643e-3;  // fine-structure constant, CODATA 2022
constexpr double g_i_d =
    -0.8574382335 * constants::nuclear_magneton / constants::bohr_magneton * (1 - alpha * alpha / 3);
constexpr std::string_view deuterium =
    "deuterium maser (splitting), Walther et al. 1972 (g_J), CODATA 2022 moment shielded by alpha^2/3 (g_I')";

// Ag: the bare nuclei's moments -0.11357(2) and -0.13056(2) mu_N (Stone 2014), as in the library of species;
// g_I' = -mu_I / (I mu_B). Shielding by the electrons, of the order of 0.5 % in silver, is left out; the
// uncertainty of 0.6 % covers it. On an effective moment that makes less than 1e-6 mu_B.
constexpr double g_i_of_moment(double nuclear_magnetons, double spin) {
  return -nuclear_magnetons / spin * constants::nuclear_magneton / constants::bohr_magneton;
}
constexpr double g_i_ag107 = g_i_of_moment(-0.11357, 0.5), g_i_ag109 = g_i_of_moment(-0.13056, 0.5);
constexpr std::string_view silver =
    "H. Dahmen, S. Penselin, Z. Phys. 200, 456 (1967) (splitting), g_J as commonly quoted, "
    "Stone 2014 without shielding (g_I')";

// clang-format off
constexpr Entry entries[] = {
    {"H",      1,  1420.405751768, 2e-9,     g_j_h,       2.6e-8,  g_i_h,          4.8e-11,   hydrogen},
    {"D",      2,   327.384352522, 2e-9,     2.002283843, 2.6e-8,  g_i_d,          5e-12,     deuterium},
    {"Li-6",   2,   228.205261,    3e-6,     2.0023010,   7e-7,    -4.476540e-4,   3e-10,     arimondo},
    {"Li-7",   3,   803.504087,    1e-6,     2.0023010,   7e-7,    -1.1822130e-3,  6e-10,     arimondo},
    {"Na-23",  3,  1771.626129,    1e-6,     2.0022960,   7e-7,    -8.046108e-4,   8e-10,     arimondo},
    {"K-39",   3,   461.719720,    1.4e-6,   2.00229421,  2.4e-7,  -1.4193489e-4,  1.2e-10,   arimondo},
    {"K-41",   3,   254.013870,    2e-6,     2.00229421,  2.4e-7,  -7.790600e-5,   8e-11,     arimondo},
    {"Rb-85",  5,  3035.732439,    5e-6,     2.00233113,  2.0e-7,  -2.936400e-4,   6e-10,     arimondo},
    {"Rb-87",  3,  6834.682610904, 9e-11,    2.00233113,  2.0e-7,  -9.951414e-4,   1.0e-9,    rubidium_87},
    {"Cs-133", 7,  9192.631770,    0,        2.00254032,  2.0e-7,  -3.9885395e-4,  5.2e-10,   caesium},
    {"Ag-107", 1, -1712.512111,    1.8e-5,   2.0023319,   0,       g_i_ag107,      7.5e-7,    silver},
    {"Ag-109", 1, -1976.932075,    1.7e-5,   2.0023319,   0,       g_i_ag109,      9e-7,      silver},
};
// clang-format on

HyperfineAtom atom_of(const Entry& entry) {
  const double splittings_of_a = (entry.twice_i + 1) / 2.0;  // I + 1/2
  return {.name = std::string(entry.name),
          .twice_i = entry.twice_i,
          .twice_j = 1,
          .hyperfine_constant = entry.splitting * 1e6 / splittings_of_a,
          .quadrupole_constant = 0,
          .g_j = entry.g_j,
          .g_i = entry.g_i,
          .hyperfine_constant_uncertainty = entry.splitting_uncertainty * 1e6 / splittings_of_a,
          .g_j_uncertainty = entry.g_j_uncertainty,
          .g_i_uncertainty = entry.g_i_uncertainty,
          .source = std::string(entry.source)};
}

}  // namespace

CoupledSpins coupled_spins(const HyperfineAtom& atom) {
  constexpr double magneton = constants::bohr_magneton / constants::planck;  // [Hz/T]
  CoupledSpins spins{.twice_i = atom.twice_i,
                     .twice_j = atom.twice_j,
                     .coupling = atom.hyperfine_constant,
                     .zeeman_i = magneton * atom.g_i,
                     .zeeman_j = magneton * atom.g_j};
  const int i = atom.twice_i, j = atom.twice_j;
  // 2I(2I-1) J(2J-1)
  if (i >= 2 && j >= 2) add_quadrupole(spins, atom.quadrupole_constant / (i * (i - 1) * (j / 2.0) * (j - 1)));
  return spins;
}

std::span<const HyperfineAtom> atom_library() {
  static const std::vector<HyperfineAtom> library = [] {
    std::vector<HyperfineAtom> out;
    for (const Entry& entry : entries) out.push_back(atom_of(entry));
    return out;
  }();
  return library;
}

const HyperfineAtom* find_atom(std::string_view name) {
  for (const HyperfineAtom& atom : atom_library())
    if (atom.name == name) return &atom;
  return nullptr;
}

}  // namespace rabiline
