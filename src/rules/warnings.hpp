#pragma once
// What deserves a word before a run although nothing is wrong.
#include <vector>

#include "beamline/beamline.hpp"
#include "core/fault.hpp"
#include "plan/plan.hpp"

namespace rabiline {

/// Warnings of the whole experiment, each once. What makes an experiment pointless is told where that is so
/// at every scan point; what makes an approximation poor, where it is so at any.
std::vector<Fault> warnings_of(const Experiment&, const Plan&);

}  // namespace rabiline
