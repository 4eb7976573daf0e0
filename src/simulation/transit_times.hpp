#pragma once
// How the slowness of what detectors catch is distributed, as moments have it anyway.
#include "plan/plan.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// Of one part of the beamline: one for each species whose moments lead to it. Particles outside the cells of
/// moments are missing.
std::vector<TransitResult> transits_to(int part, const Beamline&, const Plan&, const Sums&);

}  // namespace rabiline
