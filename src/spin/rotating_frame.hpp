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
  Eigen::VectorXd energy{};  // E_i/h
  Eigen::MatrixXd up{};  // (i, j): what takes up a photon from j to i, of -A <i|mu.u|j>/h, u in the xz plane
  double axis = 0;       // [rad] chi
};
/// In a field whose parts about +z [T] are those; what swings along it counts as in phase with what turns.
DrivenStates driven_states(const CoupledSpins& spins, const Levels& levels, const DriveParts& parts);
DrivenStates driven_states(const CoupledSpins& spins, const Levels& levels, const RotatingTerm& drive);

/// Amplitudes c_i in the laboratory are a_i exp(-i (n_i p + m_i chi)) with the drive's angle p = 2 pi f t +
/// phase. With mu_+ = mu_x + i mu_y raising m, a field that turns by +-p about +z has
/// mu.B = (A/2) (mu_+ exp(-+i p) + mu_- exp(+-i p)): with n_i = +-m_i, H in the frame is
/// E_i - n_i f + coupling, exactly. An oscillating field has exp(-i p)/2 and exp(+i p)/2 of each coupling;
/// what makes n_i - n_j = +-1 stands still: the rotating-wave approximation.
struct RotatingFrame {
  int sense = 1;               // +1 or -1; 0 of fields that swing
  double frequency = 0;        // [Hz] f
  std::vector<int> photons{};  // n_i, up to a constant of each set
  std::vector<int> set{};      // levels of one number are joined by couplings that stand still
  int clock = 0;               // whose photons they are
};

/// Asks for levels in whose frame `upper` has taken up `ahead` photons more than `lower`.
struct FrameEdge {
  int upper = 0, lower = 0, ahead = 1;
  double strength = 0;
};
/// Gives a frame its sets and photons, from the strongest edge on (Kruskal's forest); an edge joins two sets
/// where no other between them that is at least half as strong wants something else.
void join_levels(std::vector<FrameEdge> edges, RotatingFrame& frame);

/// The amplitude |V|/|detuning|; infinite on resonance.
double mixing(double coupling, double detuning);
/// Levels that a field couples, [Hz]: E_upper/h - E_lower/h is what they are apart.
struct CoupledPair {
  int upper = 0, lower = 0;
  double coupling = 0, apart = 0;
  double strength(double frequency) const { return mixing(coupling, apart - frequency); }
};
/// Below this, what two photons do is left out: it changes a probability by its square.
inline constexpr double least_of_two_photons = 1e-3;
/// What couples levels by two photons of a frequency [Hz], by way of any level, themselves included: Lowdin's
/// second order, as in standing_coupling(). `up`(i, j) [Hz]: the amplitude with which i takes up a photon
/// from j, of each part of the field whose phase against the others is not known; what two parts do adds up
/// in size. The same order shifts the line: `apart` is as far from two photons as it comes between no
/// amplitude and the full one. Pairs are left out whose strength is below least_of_two_photons anyhow.
std::vector<CoupledPair> pairs_of_two_photons(const Eigen::VectorXd& energy,
                                              std::span<const Eigen::MatrixXd> up, double frequency);

/// n_i of all fields of one sense and one clock. For an oscillating field couplings join sets of levels, by
/// the strengths |V_ij| / | |E_i - E_j|/h - f |: those far from resonance all stand still, or none does. What
/// two photons couple joins them by |S_ij| / | |E_i - E_j|/h - 2 f |.
RotatingFrame rotating_frame(std::span<const LevelLabel> labels, int sense, double frequency,
                             std::span<const DrivenStates* const> zones);

/// What stands still in the frame, in hertz, at the share g of the full amplitude: g V + g^2 S + g^3 T.
///
/// V is what the rotating-wave approximation keeps. S and T are what all the rest of an oscillating field
/// does by leaving a set of levels and coming back, to third order in V/f: the Bloch-Siegert shift, shifts by
/// levels far away, transitions of two photons. The levels i with n_i photons of the field taken up are
/// states of atom and field with the energies E_i - n_i f (J. Shirley, Phys. Rev. 138, B979 (1965)); their
/// effective Hamiltonian is that of P.-O. Lowdin, J. Chem. Phys. 19, 1396 (1951), to third order as in
/// R. Winkler, Spin-Orbit Coupling Effects (Springer, 2003), app. B. Left out is what the first order makes
/// of the states themselves: amplitudes V/f where a field begins and ends, which a random start phase takes
/// to their squares.
struct StandingCoupling {
  Eigen::MatrixXd first{}, second{}, third{};  // V, S, T
  StandingCoupling among(const std::vector<int>& levels) const {
    return {first(levels, levels), second(levels, levels), third(levels, levels)};
  }
  Eigen::MatrixXd at(double share) const { return share * (first + share * (second + share * third)); }
};
StandingCoupling standing_coupling(const RotatingFrame& frame, const DrivenStates& states);

/// Largest amplitude |V_ij| / |detuning| of what does not stand still in the frame, that of two photons
/// included; a modulation of the difference of two coupled levels counts with the detuning f. Infinite where
/// something of it is resonant.
double neglected_amplitude(const RotatingFrame& frame, const DrivenStates& states);

}  // namespace rabiline
