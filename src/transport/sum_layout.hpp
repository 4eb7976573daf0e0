#pragma once
// Where numbers stand among the sums of screens, levels, planes and histograms.
#include <cstddef>
#include <cstdint>

#include "tally/sums.hpp"

namespace rabiline {

/// The sums of levels: q and q^2 of each, then, of more than two, q times the whole weight.
struct LevelLayout {
  std::size_t levels;
  bool has_products() const { return levels > 2; }
  static std::size_t q(std::size_t level) { return 2 * level; }
  static std::size_t squares(std::size_t level) { return 2 * level + 1; }
  std::size_t products(std::size_t level) const { return 2 * levels + level; }
  std::size_t size() const { return (has_products() ? 3 : 2) * levels; }
};

/// The sums of a screen: q of what hit it and was not counted; q and q^2 of every bin, then of the whole
/// screen, then q of every group of particles; then, of each column and each row of bins, what (sum of q)^2
/// of a particle has beyond the squares of its bins, where it is split over several of them.
struct ScreenSums {
  std::size_t columns, rows;
  std::size_t bins() const { return columns * rows; }
  static std::size_t lost() { return 0; }
  static std::size_t bin(std::size_t i) { return 1 + 2 * i; }
  std::size_t total() const { return bin(bins()); }
  std::size_t group(std::size_t g) const { return total() + 2 + g; }
  std::size_t across_column(std::size_t x) const { return group(group_count) + x; }
  std::size_t across_row(std::size_t z) const { return across_column(columns) + z; }
  std::size_t size() const { return across_row(rows); }
};

/// The sums of a plane that counts: q and q^2, then q of every group of particles.
struct CensusSums {
  static std::size_t total() { return 0; }
  static std::size_t group(std::size_t g) { return 2 + g; }
  static std::size_t size() { return 2 + group_count; }
};

/// Particles are put in so many groups for the errors of means and standard deviations.
inline constexpr std::size_t moment_groups = 64;
/// Places on an axis are rounded down to 2^24 steps: q u^2 <= 2^88, so 10^12 particles fit into 128 bits.
inline constexpr double moment_steps = 0x1p24;

/// The sums of a histogram: q and q^2 of every bin and of what is outside of the axes; then of every axis
/// that is not one of levels, for each group, q, q u and q u^2, u the place on the axis in steps. Of an axis
/// that goes in a circle: q, q (1 + cos)/2 and q (1 + sin)/2, these in steps.
struct HistogramSums {
  std::size_t bins = 1, axes = 0;
  static std::size_t bin(std::size_t i) { return 2 * i; }
  std::size_t outside() const { return bin(bins); }
  std::size_t moments(std::size_t axis, std::size_t group) const {
    return 2 * bins + 2 + 3 * (axis * moment_groups + group);
  }
  std::size_t size() const { return moments(axes, 0); }
};

inline Sum square(std::uint64_t q) { return static_cast<Sum>(q) * q; }
/// A sum of products from its pieces; a negative lower one borrows, as unsigned numbers do.
inline Sum joined(std::uint64_t high, std::int64_t low) {
  return (static_cast<Sum>(high) << 40) + static_cast<Sum>(low);
}

}  // namespace rabiline
