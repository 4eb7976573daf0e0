#pragma once
// What drives the levels of an atom on a straight flight before they are asked for.
#include <vector>

#include "section/section.hpp"
#include "spin/level_drive.hpp"

namespace rabiline {

/// The fields between two places as an atom sees them, from the first that drives transitions to the last;
/// nothing where none does.
std::vector<LevelZone> driven_zones(const std::vector<Section>&, double from, double to);

}  // namespace rabiline
