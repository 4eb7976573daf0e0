#pragma once
// Levels of two coupled spins along a field of either sign, and what couples them where it changes, as tables
// that kernels read.
#include <vector>

#include "spin/coupled_spins.hpp"

namespace rabiline {

/// Levels that go over into one another where the field changes, as plain numbers. In a frame whose third
/// axis follows the field, at the angular velocity W and with the signed field b = scale tan(theta) along
/// that axis,
///   H = E_k - W . F - i (d theta/dt) <k|d/d theta l>,
/// all in rad/s. A row of numbers has cos(theta) E_k in rad/s for each level, less the mean of the manifold;
/// <to|F_-|from> of the ladder couplings; then <to|d/d theta from> of the others; then what the other
/// manifolds shift each level by, over cos(theta) (W_1^2 + W_2^2), and over cos(theta) (d theta/dt)^2; last,
/// for what drives, <low|D_-|high> and <low|D_3|high> of the pairs and <k|D_3|k> of the levels, H = D.B, over
/// `moment`.
struct LevelManifold {
  int levels = 0, ladders = 0, couplings = 0;  // the ladder couplings come first
  int width = 0;                               // of a row, a multiple of eight
  int most_of_one = 0;                         // couplings of one level
  bool is_chain = false;                       // the couplings are ladders from each level to the next
  const int* number = nullptr;                 // [level] which of the atom's levels
  const int* mirror = nullptr;                 // [level] which it is, of the atom's, with b < 0
  const double* m = nullptr;                   // [level]
  const int *to = nullptr, *from = nullptr;    // [coupling] places in the manifold
  const double* rows = nullptr;                // [cell][power][width], aligned to 64 bytes
  int cells = 0;                               // equal ones, theta from -pi/2 to pi/2
  double scale = 1;                            // [T]
  int pairs = 0;  // that a drive couples; m of `high` is that of `low` or one more
  const int *low = nullptr, *high = nullptr;  // [pair] places
  double moment = 0;                          // [rad/(s T)]
  const double* taken_off = nullptr;          // [level] of the energies [rad/s], where that is not their mean
  const double* mirror_sign =
      nullptr;  // [level] of its state against that of its mirror turned about the first axis
};
inline constexpr int most_couplings = 400, most_pairs = 400, level_powers = 8;

/// The tables of all manifolds of an atom. Within each m_F the levels never cross, so that with theta states
/// and energies run analytically from one strong field through zero to the opposite one; in each cell a
/// polynomial goes through eight Chebyshev points. There are as many cells as hold energies to 1e-13 of the
/// largest, and couplings to 1e-10.
class LevelTable {
 public:
  /// `manifold_of` as manifolds_of() says it. Where something drives in the rotating-wave approximation, all
  /// levels are flown together, each relative to the mean of its manifold at B = 0.
  LevelTable(const CoupledSpins& spins, std::vector<int> manifold_of, bool is_driven = false);

  const CoupledSpins& spins() const { return spins_; }
  const std::vector<LevelManifold>& manifolds() const { return views_; }
  /// By the atom's level: its manifold, and its place there.
  const std::vector<int>& manifold_of() const { return manifold_of_; }
  const std::vector<int>& place_of() const { return place_of_; }
  int cells() const { return cells_; }
  /// Whether some levels are left to exchange nothing, but by what drives.
  bool are_parted() const { return parted_; }
  LevelTable(const LevelTable&) = delete;
  LevelTable& operator=(const LevelTable&) = delete;

 private:
  struct alignas(64) Eight {
    double number[8];
  };
  struct Manifold {
    std::vector<int> number, mirror, to, from, low, high;
    std::vector<double> m, taken_off, mirror_sign;
    std::vector<Eight> rows;
    int ladders = 0;
    std::size_t numbers() const {
      return 3 * number.size() + to.size() + low.size() + (low.empty() ? 0 : number.size());
    }
  };
  const CoupledSpins spins_;
  int cells_ = 0;
  bool parted_ = false;
  double scale_ = 1;
  std::vector<Manifold> manifolds_;
  std::vector<LevelManifold> views_;
  std::vector<int> manifold_of_, place_of_;
};

/// By level, its manifold: levels F and F' exchange nothing where their zero-field energies are more than
/// `apart` [Hz] from each other.
std::vector<int> manifolds_of(const CoupledSpins& spins, double apart);
/// Where the energy in the field equals what the zero-field energies differ by [T].
double scale_of(const CoupledSpins& spins);

}  // namespace rabiline
