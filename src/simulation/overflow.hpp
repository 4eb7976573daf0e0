#pragma once
// Particles whose numbers overflowed, one of which is named for `rabiline trace`.
#include <string>

#include "core/isa.hpp"
#include "plan/plan.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// What is told of them, with the number of the first one; empty where there are none. Flies up to a million
/// particles again to find it.
std::string warning_of_overflow(const Experiment&, const Plan&, const Result&, Isa);

}  // namespace rabiline
