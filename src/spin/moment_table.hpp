#pragma once
// Effective moments of coupled spins against the size of the field, as a table that kernels read.
#include <vector>

#include "spin/coupled_spins.hpp"

namespace rabiline {

/// mu_n(|B|) = -dE_n/d|B| of every level n, in w = |B|/(|B| + scale), which holds every field in [0, 1): with
/// the field's energy small against the coupling's at w -> 0, and constant moments at w -> 1. The scale is
/// the field at which the two are equal, (spread of the zero-field energies)/|zeeman_j - zeeman_i|. In each
/// of equal cells in w a cubic goes through the moments at the four Chebyshev points; there are as many cells
/// as hold its error, measured in the middle of every cell, where it is largest, to 1e-9 of the largest
/// moment.
class MomentTable {
 public:
  explicit MomentTable(const CoupledSpins&);

  /// [level][cell][power] of the place in the cell, from 0 to 1; J/T.
  const std::vector<double>& coefficients() const { return coefficients_; }
  int levels() const { return levels_; }
  int cells() const { return cells_; }
  double scale() const { return scale_; }      // [T]
  double largest() const { return largest_; }  // [J/T] of all moments in size
  double error() const { return error_; }      // [J/T] the largest one measured

 private:
  void fill(const CoupledSpins&);
  double field_at(double w) const { return scale_ * w / (1 - w); }

  int levels_ = 0, cells_ = 1;
  double scale_ = 1, largest_ = 0, error_ = 0;
  std::vector<double> coefficients_;
};

}  // namespace rabiline
