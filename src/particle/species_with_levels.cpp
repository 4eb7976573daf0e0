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
    return out;
  }();
  return library;
}

}  // namespace rabiline
