#pragma once
// What a run will cost, as `check` tells it.
#include <string>

#include "rabiline.hpp"
#include "simulation/form.hpp"

namespace rabiline {

/// On this machine. A few particles of three trees are flown for it, and the others' share follows from what
/// the plan estimates. `planning`: what it took to make the plan [s].
Cost cost_of(const Experiment&, const Form&, double planning);
/// In words, as a line of a report; of a scan in slabs also how many there are.
std::string told(const Cost&, const Experiment&, const Form&);

/// Of this process, of all of its threads [s].
double processor_time();

}  // namespace rabiline
