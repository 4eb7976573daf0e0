#pragma once
// What a run will cost, as `check` tells it.
#include <string>

#include "simulation/form.hpp"

namespace rabiline {

/// In words, as a line of a report: time on one core of this machine and memory. A few particles of three
/// trees are flown for it, and the others' share follows from what the plan estimates. `planning`: what it
/// took to make the plan [s]. Of a scan in slabs also how many there are.
std::string told_cost(const Experiment&, const Form&, double planning);

/// Of this process, of all of its threads [s].
double processor_time();

}  // namespace rabiline
