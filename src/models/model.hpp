#pragma once
// The registry of models: one line per kind. Each has a table of parameters and, beside it,
//   ModelResult solve(const X&)                its motions and findings; throws std::invalid_argument with
//                                              the first fault where there is one
//   std::vector<Fact> facts_of(const X&)       what `check` tells before a run, of values without faults
//   std::vector<Fault> faults_of(const X&)     where values do not go together
#include <variant>

#include "models/bound_charge.hpp"
#include "models/charged_particle.hpp"
#include "models/rotating_cylinder.hpp"

namespace rabiline {

using Model = std::variant<RotatingCylinder,  //
                           ChargedParticle,   //
                           BoundCharge>;

}  // namespace rabiline
