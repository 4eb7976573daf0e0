#pragma once
// Whether a run fits into the machine.
#include "plan/plan.hpp"

namespace rabiline {

/// Throws std::invalid_argument where sums of every thread and of the whole, what threads keep at planes, and
/// what follows from all that need more memory than there is.
void require_memory(const Experiment&, const Plan&, int threads);

}  // namespace rabiline
