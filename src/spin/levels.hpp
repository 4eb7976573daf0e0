#pragma once
// Levels of two coupled spins in a field: energies, effective moments, states, and labels that hold at every
// field.
#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "spin/coupled_spins.hpp"
#include "spin/level_labels.hpp"

namespace rabiline {

/// All levels at one field, by their number. Columns of `states` are levels, rows the basis |m_J, m_I> of
/// CoupledSpins; the states are real, and the first component that does not vanish is positive. So a state's
/// sign does not change with the field where I.J alone couples, whose blocks have no zeros in the first row
/// of states; with (I.J)^2 it may.
struct Levels {
  double field = 0;  // [T]
  std::vector<LevelLabel> labels;
  std::vector<double> energy;  // [J] from the mean of all levels where `offset` is 0
  std::vector<double> moment;  // [J/T] effective moment -dE/dB; the force is moment * grad |B|
  Eigen::MatrixXd states;
};

/// Diagonalises H for each m_F by itself; in a field against +z, too, where m stays that along +z. The moment
/// is the expectation of -dH/dB (Hellmann and Feynman). At B = 0 states and moments are the limits from B >
/// 0, as long as no two F are degenerate by accident.
Levels levels_at(const CoupledSpins& spins, double field);

/// (E_to - E_from)/h in hertz.
double transition_frequency(const Levels& levels, int from, int to);

/// <i| mu_x, mu_y, mu_z |j> in J/T of the moment mu = -h (zeeman_i I + zeeman_j J), +z along the field; a
/// field B1 along a axis a adds -mu_a B1 to H. Row i and column j are level numbers.
std::array<Eigen::MatrixXcd, 3> dipole_matrices(const CoupledSpins& spins, const Levels& levels);

/// Boltzmann's shares of the levels at a temperature in kelvin, > 0. They add up to 1.
std::vector<double> thermal_populations(const Levels& levels, double temperature);

/// Fields in [from, to] (tesla, 0 < from < to) where the moment of a level changes its sign. Looked for
/// between 400 fields in equal ratios, then refined to rounding; the closed form for J = 1/2 is in
/// breit_rabi.hpp.
std::vector<double> zero_moment_fields(const CoupledSpins& spins, int level, double from, double to);

}  // namespace rabiline
