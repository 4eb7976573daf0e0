#pragma once
// Monitors and tallies, from exact sums to numbers with errors.
#include "simulation/finish.hpp"

namespace rabiline {

/// Adds monitors and tallies to the result. Throws std::logic_error unless what each tally has in its bins
/// and outside of them adds up, in quanta, to what crossed its plane.
void finish_tallies(const Summed&, Result&);

/// A sum of q, q u and q u^2 of a group of particles, u in steps.
struct MomentSums {
  Sum q = 0, qu = 0, quu = 0;
};
/// Mean and standard deviation in steps, with their errors from how far groups scatter.
struct MeanAndDeviation {
  double mean, mean_error, deviation, deviation_error;  // NaN where nothing was counted
};
MeanAndDeviation moments_of(const std::vector<MomentSums>& groups);
/// The same of an axis that goes in a circle [rad]: `qu` and `quu` are sums of q (1 + cos)/2 and
/// q (1 + sin)/2.
MeanAndDeviation direction_of(const std::vector<MomentSums>& groups);

}  // namespace rabiline
