#pragma once
#include "simulation/result.hpp"

namespace rabiline {

/// Puts the scan points of a result behind those of another one, or in an empty one. Both are of one flight,
/// and without covariances between their points; what is known of the flight is that of the first.
void append(Result&& points, Result& all);

/// Drops what a result has for each point but for what is told of a run: what was emitted, what was detected
/// with its errors and covariances, and what overflowed.
void keep_totals(Result& points);

}  // namespace rabiline
