#pragma once
// Whether each field of a beam turns spins, and whether it moves particles.
#include <string>

#include "beamline/beamline.hpp"

namespace rabiline {

/// [part] Whether its field moves any species of the beam.
std::vector<bool> parts_that_move_paths(const Beamline&);

/// A line for each part with a field; empty where there is none.
std::string report_of_parts(const Beamline&);

}  // namespace rabiline
