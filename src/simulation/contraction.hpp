#pragma once
// From moments of the slowness to what each scan point counts.
#include <vector>

#include "simulation/count_covariance.hpp"

namespace rabiline {

/// Adds what follows from the moments to the sums of every reweighting, and tells how the counts
/// of screens go together; `threads` as for in_parallel(). Throws std::logic_error where moments do not add
/// up to what was booked.
std::vector<CountCovariance> contract_moments(const Plan&, int threads, Sums&);

}  // namespace rabiline
