#pragma once
// From exact sums to numbers with errors.
#include "plan/plan.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// Half the width of Wilson's interval (1927) at one standard deviation, for k of n: never zero, never
/// outside.
double wilson_error(double k, double n);

/// Everything of a Result but its provenance. Throws std::logic_error if the fates do not add up to what was
/// emitted, in quanta.
Result finish(const Experiment&, const Plan&, const Sums&);

}  // namespace rabiline
