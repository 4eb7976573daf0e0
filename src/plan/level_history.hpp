#pragma once
// What drives the levels of an atom on a straight flight before they are asked for.
#include <vector>

#include "beamline/beamline.hpp"
#include "section/section.hpp"
#include "spin/level_drive.hpp"

namespace rabiline {

/// The fields between two places as an atom sees them, from the first that drives transitions to the last;
/// nothing where none does.
std::vector<LevelZone> driven_zones(const std::vector<Section>&, double from, double to);

/// The largest angle [rad] to +y at which the source sends anything that may reach a plane, or most of it.
double steepest_before(const Plane&, const Beamline&, const Sections&);

/// Slownesses along the beam 1/v_y [s/m] of what flies at that angle at most, but for at most 1e-4 of it.
struct SlownessRange {
  double from = 0, to = 0;
};
SlownessRange slownesses_of(const Source&, double mass, double steepest);

}  // namespace rabiline
