"""Physical numbers that tests compare with: CODATA 2022 (P. Mohr, D. Newell, B. Taylor, E. Tiesinga, NIST, May 2024), in SI."""

import math

PLANCK, BOLTZMANN, CHARGE = 6.62607015e-34, 1.380649e-23, 1.602176634e-19  # exact
HBAR = PLANCK / (2 * math.pi)
DALTON = 1.66053906892e-27
BOHR, NUCLEAR = 9.2740100657e-24, 5.0507837393e-27  # magnetons [J/T]
NEUTRON, PROTON = 1.67492750056e-27, 1.67262192595e-27  # masses [kg]
GAMMA = -2 * math.pi * 29.1646935e6  # rad/(s T), neutron
