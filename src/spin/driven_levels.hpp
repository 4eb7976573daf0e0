#pragma once
// Transitions between the levels of two coupled spins that cross static fields along +z and fields that drive
// them.
#include <Eigen/Core>
#include <utility>
#include <vector>

#include "spin/coupled_spins.hpp"
#include "spin/evolution.hpp"
#include "spin/level_drive.hpp"

namespace rabiline {

/// The levels along zones, coherently from the first to the last, as a function of the slowness s = 1/v
/// [s/m].
///
/// In each zone the levels are those of its field; between zones they keep their names. A rotating field is
/// exact in the frame that turns with it, an oscillating one is taken in the rotating-wave approximation
/// (rotating_frame.hpp). Phases come from energies less the photons' n_i f, in hertz, so that they keep their
/// digits. Envelopes are cut into slices, 4th-order Magnus without commutators (S. Blanes, P. Moan, Appl.
/// Numer. Math. 56, 1519 (2006)), to 3e-8 in amplitudes up to the largest slowness.
class DrivenLevels {
 public:
  /// Zones ascend along the beam; between them there is no field. Fields of one clock have one frequency.
  /// Throws std::invalid_argument otherwise.
  DrivenLevels(const CoupledSpins& spins, std::vector<LevelZone> zones, double largest_slowness);

  int levels() const { return levels_; }
  /// P(from -> to), row from, column to, by the levels' numbers; the mean over random start phases.
  Eigen::MatrixXd probabilities(double slowness) const;
  /// Pairs of levels (from, to) between which particles can go; all others have the probability 0.
  std::vector<std::pair<int, int>> connected() const;
  /// Their probabilities, in the same order.
  void put_probabilities(double slowness, double* out) const;
  /// Largest amplitude |V_ij| / |detuning| of the couplings that the rotating-wave approximation leaves out;
  /// 0 for rotating fields.
  double neglected() const { return neglected_; }
  /// About the largest frequency of the probabilities as functions of the slowness, in cycles per s/m,
  /// without what amounts to less than a few 1e-3.
  double fastest() const { return fastest_; }

 private:
  /// Levels that are connected by couplings kept somewhere.
  struct Block {
    std::vector<int> levels{};
    Evolution evolution;
  };
  int levels_ = 0;
  double neglected_ = 0, fastest_ = 0;
  std::vector<Block> blocks_;
};

}  // namespace rabiline
