#pragma once
// From exact sums to numbers with errors.
#include "plan/plan.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// Everything of a Result but its provenance. Throws std::logic_error if the fates do not add up to what was
/// emitted, in quanta.
Result finish(const Experiment&, const Plan&, Sums);

}  // namespace rabiline
