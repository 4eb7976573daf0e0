#pragma once
// The text of `rabiline check` about what the chosen laws leave out.
#include <string>
#include <vector>

#include "plan/plan.hpp"

namespace rabiline {

/// Warnings where a species of any scan point flies so fast, in the mean, that (v/c)^2 exceeds 1e-3, since no
/// law here knows relativity; and where a law at any scan point takes the force of a gradient away from the
/// magnets.
std::vector<std::string> warnings_of_laws(const Experiment&);

}  // namespace rabiline
