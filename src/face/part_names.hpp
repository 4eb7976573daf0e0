#pragma once
// The parts of a beamline as pictures show them.
#include <vector>

#include "beamline/beamline.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// By their place.
std::vector<PartName> names_of(const std::vector<PlacedPart>&);

}  // namespace rabiline
