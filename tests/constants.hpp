#pragma once
// Physical numbers that tests compare with: written here once more, so that a wrong one in src is found.
// CODATA 2022 (P. Mohr, D. Newell, B. Taylor, E. Tiesinga, NIST, May 2024), in SI; e, h and k_B are exact.
#include <numbers>

namespace rabiline::test {

inline constexpr double pi = std::numbers::pi, two_pi = 2 * pi;
inline constexpr double elementary_charge = 1.602176634e-19;  // [C]
inline constexpr double planck = 6.62607015e-34;              // [J s]
inline constexpr double hbar = planck / two_pi;               // [J s]
inline constexpr double boltzmann = 1.380649e-23;             // [J/K]
inline constexpr double atomic_mass = 1.66053906892e-27;      // [kg]
inline constexpr double bohr_magneton = 9.2740100657e-24;     // [J/T]
inline constexpr double neutron_mass = 1.67492750056e-27;     // [kg]
inline constexpr double gamma_n = -1.83247174e8;              // [rad/(s T)] of the neutron, with its sign
inline constexpr double proton_mass = 1.67262192595e-27;      // [kg]

}  // namespace rabiline::test
