#pragma once
// Detectors, from exact sums to histograms, fractions and levels with errors.
#include "simulation/count_covariance.hpp"
#include "simulation/finish.hpp"

namespace rabiline {

/// Adds the detectors to a result that knows what was emitted. `covariances`: of what was booked as moments.
void finish_detectors(const Summed&, Result&);

}  // namespace rabiline
