#pragma once
// What drives the levels of an atom on a straight flight before they are asked for.
#include <vector>

#include "section/section.hpp"
#include "spin/level_drive.hpp"

namespace rabiline {

/// Whether there is a frame in which levels along +z and what drives them stand still, in the rotating-wave
/// approximation at least.
bool has_standing_frame(const RotatingTerm&);

/// The fields between two places as an atom sees them, from the first that drives transitions to the last;
/// nothing where none does. Only where no field needs more (needs_way).
std::vector<LevelZone> driven_zones(const std::vector<Section>&, double from, double to);

}  // namespace rabiline
