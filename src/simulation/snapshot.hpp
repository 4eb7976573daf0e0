#pragma once
// Where a run stands between two blocks of work.
#include <compare>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/diagnostics.hpp"

namespace rabiline {

/// How far a run is.
struct Progress {
  double done = 0;          // fraction of the work
  double seconds = 0;       // since this run began
  double seconds_left = 0;  // estimate
  /// Where the run ends at a precision: the error of `detected` so far, or 0. `done` then is that of the part
  /// under way.
  double error = 0;
};

/// A particle that was too slow or too fast for cells of moments.
struct Straggler {
  std::uint64_t tree, particle;  // of the plan; its number
  auto operator<=>(const Straggler&) const = default;
};

/// Everything that a run needs to go on: which blocks are finished, and the exact sums over them.
struct Snapshot {
  std::string fingerprint;                 // of the experiment; a snapshot of another one is refused
  std::vector<std::uint64_t> block_sizes;  // particles in a block of each tree of the plan
  /// Half-open intervals of block numbers, ascending and disjoint.
  std::vector<std::pair<std::uint64_t, std::uint64_t>> finished;
  std::vector<std::uint64_t> sums_high, sums_low;  // exact 128-bit sums: high * 2^64 + low
  std::vector<Straggler> stragglers;               // among the finished particles
  std::vector<std::string> arguments;              // of the run
  std::vector<InputText> inputs;
};

}  // namespace rabiline
