#pragma once
// Frames in which levels along a field of any direction stand nearly still where one frequency drives them.
#include <span>
#include <vector>

#include "spin/coupled_spins.hpp"

namespace rabiline {

/// A static field at one place and the size there of what drives at one frequency, Re(c exp(-i w t)) with a
/// complex vector c, in axes whose third is along the static field: |c_1 + i c_2|, |c_1 - i c_2| and |c_3|.
struct WavePlace {
  double field = 0;    // [T]
  double turning = 0;  // [rad/s] about how fast a particle sees its direction change, by whole fields too
  double lowering = 0, raising = 0, along = 0;  // [T] what takes up a photon and m - 1, m + 1 or m
  double fastest = 0;                           // [Hz] of whole fields that drive there
};

/// What two photons of the drive couple: `upper` has taken up both, or as many as it has given off.
struct TwoPhotons {
  int upper = 0, lower = 0, ahead = 2;
  bool operator==(const TwoPhotons&) const = default;
};

/// What one frequency [Hz] > 0 drives along a way.
struct WaveAlong {
  double frequency = 0;
  std::vector<WavePlace> places{};
};

/// Amplitudes c_k in the laboratory are a_k exp(-i rate_k t), rate_k = 2 pi (n_k f + e_set). A coupling by
/// the drive stands still where n differs by one photon, and by the turning of the static field where it does
/// not differ, within one set. What does neither acts to second order: as a shift, and as what two photons
/// couple.
struct WaveFrame {
  std::vector<int> photons{}, set{};  // [level]
  std::vector<double> rate{};         // [rad/s]
  std::vector<TwoPhotons> two{};      // of one set, that stand still and matter
  double neglected = 0;               // the largest amplitude |V|/|detuning| of what does not stand still
  bool operator==(const WaveFrame&) const = default;

  /// Whether a coupling does by which `one` has taken up so many photons more than the other.
  bool stand_still(int one, int other, int ahead) const {
    const auto i = static_cast<std::size_t>(one), j = static_cast<std::size_t>(other);
    return set[i] == set[j] && photons[i] - photons[j] == ahead;
  }
};

/// For frequencies that drive along one way; photons are of the first one, beside which another one's
/// couplings still turn by the difference. Couplings near resonance anywhere on it come first, then levels of
/// one manifold (LevelTable) that the turning of the static field mixes, then what is far from resonance. All
/// have as many places, and drive for about that time [s].
WaveFrame wave_frame(const CoupledSpins& spins, const std::vector<int>& manifold_of,
                     std::span<const WaveAlong> waves, double time);

}  // namespace rabiline
