#pragma once
// From exact sums to numbers with errors.
#include <string>
#include <vector>

#include "simulation/part_numbers.hpp"
#include "simulation/result.hpp"
#include "simulation/tallies.hpp"

namespace rabiline {

struct CountCovariance;

/// What a run has left, to be read only.
struct Summed {
  const Experiment& experiment;
  const Plan& plan;
  const Sums& sums;
  const Tallies& tallies;
  const std::vector<Moments>& emitted;  // [points]
  const std::vector<CountCovariance>& covariances;
  const PartNumbers parts;

  /// Between the counted fractions of two points, of what was booked as moments.
  double covariance_by_moments(const std::string& part, int plane, std::size_t a, std::size_t b) const;
};

/// Everything of a Result but its provenance. Throws std::logic_error if the fates do not add up to what was
/// emitted, in quanta. `threads`: as for in_parallel().
Result finish(const Experiment&, const Plan&, Sums, int threads = 1);

}  // namespace rabiline
