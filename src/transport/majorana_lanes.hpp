#pragma once
// Majorana's formula for lanes of different levels, for kernels only.
#include "core/lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// Probability to find level `to` of a state |from> whose image of z flips with that probability: a
/// polynomial in it, coefficients[(from levels + to) levels + power].
RABILINE_LANES real majorana(const double* coefficients, int levels, int from, int to, real flip) {
  const double* c = coefficients + (from * levels + to) * levels;
  real sum = broadcast(c[levels - 1]);
  for (int k = levels - 2; k >= 0; --k) sum = fma(sum, flip, broadcast(c[k]));
  return max(broadcast(0), min(broadcast(1), sum));
}

/// The same for lanes of different levels.
inline real outcome_probability(const double* coefficients, int levels, words from, int to, real flip) {
  real probability = broadcast(0);
  for (int start = 0; start < levels; ++start) {
    const mask here = from == broadcast_word(static_cast<unsigned long long>(start));
    if (any(here)) probability = select(here, majorana(coefficients, levels, start, to, flip), probability);
  }
  return probability;
}

}  // namespace rabiline::RABILINE_ISA
