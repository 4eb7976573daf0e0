#pragma once
// Exact sums of quanta. Integers, so that their order, and with it threads, batches and resumes, cannot
// matter.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/zeroed_memory.hpp"

namespace rabiline {

/// 128 bits: a sum of squares of weights (2^80 each) over more particles than a computer can fly.
__extension__ typedef unsigned __int128 Sum;
__extension__ typedef __int128 SignedSum;

/// All sums of a plan in one array; each stage knows where its own begin.
using Sums = std::vector<Sum, ZeroedMemory<Sum>>;

inline void add(Sums& to, const Sums& from) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
}

/// A sum of q and one of q^2, over particles.
struct Moments {
  Sum q = 0, q2 = 0;
};

/// Particles are counted in groups by number: their spread gives the covariance between scan points.
inline constexpr int group_count = 256;

}  // namespace rabiline
