#pragma once
// What fields that differ from place to place say of themselves: how they end, and how good their maps are.
#include <string>
#include <vector>

#include "beamline/beamline.hpp"
#include "core/fault.hpp"

namespace rabiline {

/// A line for each such field, a second one for a map; empty where there is none.
std::string report_of_fields(const Beamline&);
/// What of that deserves a warning.
std::vector<Fault> warnings_of_fields(const Beamline&);

}  // namespace rabiline
