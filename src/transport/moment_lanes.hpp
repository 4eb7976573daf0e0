#pragma once
// Moments of the levels of an atom, for kernels only.
#include "core/lanes.hpp"
#include "transport/moment_law.hpp"

namespace rabiline::RABILINE_ISA {

/// The moments of lanes in different levels, one lane after the other: the same bits everywhere.
inline real moment_of(const MomentLaw& law, words level, real size) {
  const real place = size / (size + law.scale) * law.cells;
  const real cell = min(floor(place), broadcast(law.cells - 1)), t = place - cell;
  real c[4] = {};
  for (int k = 0; k < lane_count; ++k) {
    const double* row = law.coefficients + 4 * (static_cast<long>(lane(level, k)) * law.cells +
                                                static_cast<long>(lane(cell, k)));
    for (int power = 0; power < 4; ++power) set_lane(c[power], k, row[power]);
  }
  return fma(fma(fma(c[3], t, c[2]), t, c[1]), t, c[0]);
}

}  // namespace rabiline::RABILINE_ISA
