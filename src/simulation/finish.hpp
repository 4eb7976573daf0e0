#pragma once
// From exact sums to numbers with errors.
#include "simulation/result.hpp"
#include "simulation/tallies.hpp"

namespace rabiline {

/// What a run has left, to be read only.
struct Summed {
  const Experiment& experiment;
  const Plan& plan;
  const Sums& sums;
  const Tallies& tallies;
  const std::vector<Moments>& emitted;  // [points]
};

/// Everything of a Result but its provenance. Throws std::logic_error if the fates do not add up to what was
/// emitted, in quanta. `threads`: as for in_parallel().
Result finish(const Experiment&, const Plan&, Sums, int threads = 1);

}  // namespace rabiline
