#pragma once
// The plan in words, with the numbers that a physicist wants before a run.
#include <string>
#include <vector>

#include "core/fault.hpp"
#include "plan/plan.hpp"

namespace rabiline {

/// What will be computed: species, stages with the points that share them, derived numbers of every field.
std::string explain(const Experiment&, const Plan&);

/// What the stages that the first scan point passes warn of.
std::vector<Fault> warnings_of_stages(const Experiment&, const Plan&);

}  // namespace rabiline
