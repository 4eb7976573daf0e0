#pragma once
// Transition probabilities between levels, tabulated in the slowness.
#include <cstddef>
#include <vector>

#include "spin/driven_levels.hpp"

namespace rabiline {

/// Equal steps in the slowness s = 1/v; between them cubic polynomials through the four nearest points. One
/// point with step 0 holds for one slowness. From each level only those are kept that it can go to.
struct TransitionTable {
  int levels = 0;
  double first = 0, step = 0;  // [s/m]
  int points = 0;
  std::vector<int> begin{};     // [levels + 1] where the targets of each level begin
  std::vector<int> targets{};   // levels, rising for each
  std::vector<float> values{};  // [point][target], and a few zeros to load whole vectors at the end
  double error = 0;             // bound of the probabilities' error, as measured between points

  int row() const { return static_cast<int>(targets.size()); }
  double at(int point, int target) const {
    return static_cast<double>(
        values[static_cast<std::size_t>(point) * targets.size() + static_cast<std::size_t>(target)]);
  }
};

/// Points are doubled until the bound falls below the tolerance or no more are allowed; the bound tells.
TransitionTable tabulate(const DrivenLevels& driven, double from, double to, double tolerance = 1e-6,
                         int most_points = 1 << 14);

}  // namespace rabiline
