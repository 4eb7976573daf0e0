#pragma once
// Transition probabilities between levels, tabulated in the slowness.
#include <cstddef>
#include <vector>

#include "spin/driven_levels.hpp"

namespace rabiline {

/// Equal steps in the slowness s = 1/v; between them cubic polynomials through the four nearest points. One
/// point with step 0 holds for one slowness.
struct TransitionTable {
  int levels = 0;
  double first = 0, step = 0;  // [s/m]
  int points = 0;
  std::vector<double> values{};  // [point][from][to], each row filled up with zeros to stride()
  double error = 0;              // bound of the probabilities' error, as measured between points

  int stride() const { return (levels + 7) / 8 * 8; }
  const double* row(int point, int from) const {
    return values.data() + (static_cast<std::ptrdiff_t>(point) * levels + from) * stride();
  }
};

/// Points are doubled until the bound falls below the tolerance or no more are allowed; the bound tells.
TransitionTable tabulate(const DrivenLevels& driven, double from, double to, double tolerance = 1e-6,
                         int most_points = 1 << 14);

/// P(from -> to), within [0, 1]. Outside the table's range that at its end.
double probability(const TransitionTable& table, int from, int to, double slowness);

}  // namespace rabiline
