#pragma once
// Constants of atoms with hyperfine structure, and their Hamiltonian.
#include <span>
#include <string>
#include <string_view>

#include "spin/coupled_spins.hpp"

namespace rabiline {

/// An atom in one electronic level J with a nuclear spin I:
///   H/h = A I.J + B_quadrupole [3 (I.J)^2 + (3/2) I.J - I(I+1) J(J+1)] / (2I(2I-1) J(2J-1))
///         + (mu_B/h) B (g_J J_z + g_I' I_z)
/// with +z along B, g_J > 0 for an electron, and g_I' in Bohr magnetons with the sign of E. Arimondo,
/// M. Inguscio, P. Violino, Rev. Mod. Phys. 49, 31 (1977) and of D. Steck: g_I' = -mu_I / (I mu_B) with the
/// moment mu_I as the electrons shield it, so negative for a positive one. A is negative where the largest F
/// is the lowest (inverted structure). Uncertainties are standard ones; 0 is exact or none stated.
struct HyperfineAtom {
  std::string name;
  int twice_i = 0;                            // 2I
  int twice_j = 1;                            // 2J
  double hyperfine_constant = 0;              // [Hz] A
  double quadrupole_constant = 0;             // [Hz] B_quadrupole; has an effect for I >= 1 and J >= 1
  double g_j = 0;                             // g_J
  double g_i = 0;                             // g_I'
  double hyperfine_constant_uncertainty = 0;  // [Hz]
  double g_j_uncertainty = 0;
  double g_i_uncertainty = 0;
  std::string source;  // where the constants come from
  bool operator==(const HyperfineAtom&) const = default;
};

CoupledSpins coupled_spins(const HyperfineAtom& atom);

/// Ground states (J = 1/2) of H, D, the alkalis and silver.
std::span<const HyperfineAtom> atom_library();
/// The atom of that name, as in the library of species, or nullptr.
const HyperfineAtom* find_atom(std::string_view name);

}  // namespace rabiline
