#pragma once
// Transitions between the levels of two coupled spins that cross static fields along +z or against it, and
// fields that drive them.
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "spin/coupled_spins.hpp"
#include "spin/level_block.hpp"
#include "spin/level_drive.hpp"

namespace rabiline {

/// The levels along zones, coherently from the first to the last, as a function of the slowness s = 1/v
/// [s/m]; kernels work it out for each particle.
///
/// In each zone the levels are those of its field; between zones they keep their names. A rotating field is
/// exact in the frame that turns with it, an oscillating one is taken as what stands still in such a frame
/// (rotating_frame.hpp). Phases come from energies less the photons' n_i f, in hertz, so that they keep their
/// digits. In constant fields and between zones the evolution is exact at every slowness. Envelopes are cut
/// into slices, 4th-order Magnus without commutators (S. Blanes, P. Moan, Appl. Numer. Math. 56, 1519
/// (2006)), to 3e-9 in amplitudes up to the largest slowness.
class DrivenLevels {
 public:
  DrivenLevels() = default;
  /// Zones ascend along the beam; between them there is no field. Fields of one clock have one frequency.
  /// Throws std::invalid_argument otherwise.
  DrivenLevels(const CoupledSpins& spins, std::vector<LevelZone> zones, double largest_slowness);

  int levels() const { return static_cast<int>(block_of_.size()); }
  /// Levels that go over into one another, directly or through others.
  const std::vector<LevelBlock>& blocks() const { return blocks_; }
  const std::vector<int>& levels_of_blocks() const { return levels_; }
  const std::vector<double>& numbers() const { return numbers_; }
  /// By level: its block, or -1 where it stays what it is.
  const std::vector<int>& block_of() const { return block_of_; }
  /// Bits of the levels that one can go to.
  std::uint64_t reachable_from(int level) const;
  /// Largest amplitude |V_ij| / |detuning| of the couplings that the rotating-wave approximation leaves out;
  /// 0 for rotating fields.
  double neglected() const { return neglected_; }
  /// Most photons that levels of one block are apart, where one frame holds for all drives; else 0.
  int photons() const { return photons_; }
  /// Operations that one particle takes, about, if each level is as likely.
  double work() const;

 private:
  double neglected_ = 0;
  int photons_ = 0;
  std::vector<LevelBlock> blocks_{};
  std::vector<int> levels_{}, block_of_{};
  std::vector<double> numbers_{};
};

}  // namespace rabiline
