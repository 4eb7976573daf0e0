#pragma once
#include "plan/plan.hpp"

namespace rabiline {

/// Adds to `to` what does not depend on the scan point: from the sums of one plan to those of another of the
/// same flight, where bins of screens may be added up. Throws std::invalid_argument where it is another one.
void copy_flight(const Plan& of, const Sums& from, const Plan& plan, Sums& to);

}  // namespace rabiline
