#pragma once
// What the chosen laws leave out.
#include <vector>

#include "core/fault.hpp"
#include "plan/plan.hpp"

namespace rabiline {

/// Warnings where a species of any scan point flies so fast, in the mean, that (v/c)^2 exceeds 1e-3, since no
/// law here knows relativity; and where a law at any scan point takes the force of a gradient away from the
/// magnets.
std::vector<Fault> warnings_of_laws(const Experiment&);

}  // namespace rabiline
