#pragma once
// Detectors, from exact sums to histograms, fractions and levels with errors.
#include "simulation/finish.hpp"
#include "simulation/screen_covariance.hpp"

namespace rabiline {

/// Adds the detectors to a result that knows what was emitted. `covariances`: of what was booked as moments.
void finish_detectors(const Summed&, const std::vector<ScreenCovariance>& covariances, Result&);

}  // namespace rabiline
