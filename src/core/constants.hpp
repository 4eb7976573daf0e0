#pragma once
// CODATA 2022 recommended values (P. Mohr, D. Newell, B. Taylor, E. Tiesinga, NIST, May 2024), in SI.
// c, e, h and k_B are exact by the definition of the units.
#include <numbers>

namespace rabiline::constants {

inline constexpr double two_pi = 2 * std::numbers::pi;
inline constexpr double speed_of_light = 299792458;              // [m/s] c, exact
inline constexpr double elementary_charge = 1.602176634e-19;     // [C] e, exact
inline constexpr double planck = 6.62607015e-34;                 // [J s] h, exact
inline constexpr double hbar = planck / two_pi;                  // [J s]
inline constexpr double boltzmann = 1.380649e-23;                // [J/K] k_B, exact
inline constexpr double atomic_mass = 1.66053906892e-27;         // [kg] u
inline constexpr double nuclear_magneton = 5.0507837393e-27;     // [J/T] mu_N
inline constexpr double bohr_magneton = 9.2740100657e-24;        // [J/T] mu_B
inline constexpr double vacuum_permeability = 1.25663706127e-6;  // [T m/A] mu_0
inline constexpr double vacuum_permittivity =
    1 / (vacuum_permeability * speed_of_light * speed_of_light);  // [F/m] epsilon_0 = 1/(mu_0 c^2)

}  // namespace rabiline::constants
