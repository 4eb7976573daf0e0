#include "spin/moment_table.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "core/portable_math.hpp"
#include "spin/levels.hpp"

namespace rabiline {
namespace {

constexpr double tolerance = 1e-9;  // of the largest moment
constexpr int fewest_cells = 32, most_cells = 2048;

/// Largest difference of the energies at B = 0 [Hz].
double zero_field_spread(const CoupledSpins& spins) {
  double low = 0, high = 0;
  const int least = std::abs(spins.twice_i - spins.twice_j);
  for (int f = least; f <= spins.twice_i + spins.twice_j; f += 2) {
    const double energy = zero_field_energy(spins, f);
    low = f == least ? energy : std::min(low, energy);
    high = f == least ? energy : std::max(high, energy);
  }
  return high - low;
}

/// The Chebyshev points of [0, 1].
Eigen::Vector4d chebyshev_points() {
  Eigen::Vector4d points;
  for (int k = 0; k < 4; ++k) points(k) = (1 - portable::cos((2 * k + 1) * std::numbers::pi / 8)) / 2;
  return points;
}

}  // namespace

MomentTable::MomentTable(const CoupledSpins& spins) : levels_(spins.levels()) {
  const double spread = zero_field_spread(spins), zeeman = std::abs(spins.zeeman_j - spins.zeeman_i);
  const bool constant = spread == 0 || zeeman == 0;
  if (!constant) scale_ = spread / zeeman;
  cells_ = constant ? 1 : fewest_cells;
  for (fill(spins); error_ > tolerance * largest_ && cells_ < most_cells; fill(spins)) cells_ *= 2;
}

void MomentTable::fill(const CoupledSpins& spins) {
  const Eigen::Vector4d points = chebyshev_points();
  Eigen::Matrix4d powers;
  for (int k = 0; k < 4; ++k)
    powers.row(k) << 1, points(k), points(k) * points(k), points(k) * points(k) * points(k);
  const Eigen::Matrix4d solve = powers.inverse();
  coefficients_.assign(std::size_t{4} * static_cast<std::size_t>(levels_) * static_cast<std::size_t>(cells_),
                       0);
  largest_ = error_ = 0;
  Eigen::MatrixXd moments(4, levels_);
  for (int cell = 0; cell < cells_; ++cell) {
    for (int k = 0; k < 4; ++k) {
      const Levels at = levels_at(spins, field_at((cell + points(k)) / cells_));
      for (int n = 0; n < levels_; ++n) moments(k, n) = at.moment[n];
    }
    largest_ = std::max(largest_, moments.cwiseAbs().maxCoeff());
    const Eigen::MatrixXd fitted = solve * moments;
    for (int n = 0; n < levels_; ++n)
      std::copy_n(fitted.col(n).data(), 4, coefficients_.begin() + std::ptrdiff_t{4} * (n * cells_ + cell));
  }
  for (int cell = 0; cell < cells_; ++cell) {
    const Levels middle = levels_at(spins, field_at((cell + 0.5) / cells_));
    for (int n = 0; n < levels_; ++n) {
      const double* c = coefficients_.data() + std::ptrdiff_t{4} * (n * cells_ + cell);
      const double fitted = c[0] + 0.5 * (c[1] + 0.5 * (c[2] + 0.5 * c[3]));
      error_ = std::max(error_, std::abs(middle.moment[n] - fitted));
    }
  }
}

}  // namespace rabiline
