#pragma once
// Every parameter of a beamline with its value, defaults included, as results keep them.
#include "beamline/experiment.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// Numbers in SI and words, by dotted names; of what differs between the points of a scan, one for each of
/// them.
std::vector<ResolvedParameter> resolved_parameters(const ScanPoints& points);

}  // namespace rabiline
