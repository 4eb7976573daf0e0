#pragma once
// Closed forms for an atom with J = 1/2 in a field: G. Breit, I. Rabi, Phys. Rev. 38, 2082 (1931).
#include <optional>

#include "spin/atoms.hpp"

namespace rabiline {

/// The level (F, m_F), F = I + 1/2 or I - 1/2, of an atom with J = 1/2 in the field B >= 0 along +z.
///
/// With D = A (I + 1/2), which is negative for an inverted structure, u = 2 m_F/(2I+1) and
/// x = (g_J - g_I') mu_B B / hD, of the sign of D:
///   E  = -hD / (2(2I+1)) + g_I' mu_B m_F B +- (hD/2) r,    r = sqrt(1 + 2ux + x^2),  + for F = I + 1/2
///   mu = -dE/dB = -g_I' mu_B m_F -+ (g_J - g_I')/2 mu_B (u + x)/r
/// At |m_F| = I + 1/2, u = +-1 and r = 1 + ux without a modulus: those two are straight lines. Computed as
/// R = (h|D|/2) r, which also holds at A = 0, the limit of a vanishing positive A.
struct BreitRabi {
  double energy = 0;  // [J] from the mean of all levels
  double moment = 0;  // [J/T] -dE/dB
};

BreitRabi breit_rabi(const HyperfineAtom& atom, int twice_f, int twice_m, double field);

/// The field B > 0 in tesla where the moment of (F, m_F) vanishes, if there is one. From mu = 0, with
/// s = u + x, r^2 = 1 - u^2 + s^2 and c = s/r = -+2 g_I' m_F/(g_J - g_I'), - for F = I + 1/2:
///   s = c sqrt((1 - u^2)/(1 - c^2)),  x = s - u
/// Close to x = -u, so for a normal structure both levels of each m_F < 0 have one; stretched levels have
/// none.
std::optional<double> zero_moment_field(const HyperfineAtom& atom, int twice_f, int twice_m);

/// The shift of the line (I+1/2, 0) - (I-1/2, 0) per field squared, at B -> 0, in Hz/T^2:
///   (g_J - g_I')^2 mu_B^2 / (2 h^2 |D|);   1 Hz/G^2 = 1e8 Hz/T^2. For half-integer I.
double clock_quadratic_shift(const HyperfineAtom& atom);

}  // namespace rabiline
