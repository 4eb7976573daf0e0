#pragma once
// The frame in which a driven atom's Hamiltonian stands still.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "spin/level_drive.hpp"
#include "spin/levels.hpp"

namespace rabiline {

/// Levels in a static field and what a drive adds to H/h at full amplitude, both in hertz.
///
/// A transverse axis at the angle chi to +x, u = R x with R = exp(-i F_z chi), has the elements
/// (mu.u)_ij = exp(-i (m_i - m_j) chi) (mu_x)_ij. The phases are left to the amplitudes, so that everything
/// here is real.
struct DrivenStates {
  Eigen::VectorXd energy{};    // E_i/h
  Eigen::MatrixXd coupling{};  // -A <i|mu.u|j>/h at p = 0, u turned into the xz plane
  double axis = 0;             // [rad] chi
};
DrivenStates driven_states(const CoupledSpins& spins, const Levels& levels, const RotatingTerm& drive);

/// Amplitudes c_i in the laboratory are a_i exp(-i (n_i p + m_i chi)) with the drive's angle p = 2 pi f t +
/// phase. With mu_+ = mu_x + i mu_y raising m, a field that turns by +-p about +z has
/// mu.B = (A/2) (mu_+ exp(-+i p) + mu_- exp(+-i p)): with n_i = +-m_i, H in the frame is
/// E_i - n_i f + coupling, exactly. Of an oscillating field exp(-+i p)/2 each is kept where it makes
/// n_i - n_j = +-1 with i the upper level: the rotating-wave approximation.
struct RotatingFrame {
  int clock = 0;
  int sense = 1;               // +1 or -1; 0 of fields that swing
  double frequency = 0;        // [Hz] f
  std::vector<int> photons{};  // n_i, up to a constant of each set of connected levels
};

/// n_i of all fields of one sense and one clock. For an oscillating field the couplings are joined from the
/// smallest detuning | |E_i - E_j|/h - f | up, wherever they are in accord (Kruskal's forest): the nearest
/// resonances are never left out.
RotatingFrame rotating_frame(std::span<const LevelLabel> labels, const RotatingTerm& drive,
                             std::span<const DrivenStates* const> zones);

/// V_ij [Hz] that stands still in the frame.
Eigen::MatrixXd kept_coupling(const RotatingFrame& frame, const DrivenStates& states);

/// Largest amplitude |V_ij| / |detuning| of what the frame leaves out; a modulation of the difference of two
/// coupled levels counts with the detuning f. Infinite where something left out is resonant.
double neglected_amplitude(const RotatingFrame& frame, const DrivenStates& states);

/// [Hz] By how much the half of an oscillating field that the frame leaves out shifts a transition, to second
/// order (Bloch and Siegert 1940): each pair of levels is pushed apart by (C/2)^2/(|E_i - E_j|/h + f), C
/// their coupling; C^2/(4f) where there are two levels.
double counter_rotating_shift(const DrivenStates& states, double frequency, int upper, int lower);

}  // namespace rabiline
