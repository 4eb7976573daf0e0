#pragma once
// Every parameter of a beamline or a model with its value, defaults included, as results keep them.
#include "beamline/experiment.hpp"
#include "scan/model_file.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// Numbers in SI and words, by dotted names; of what differs between the points of a scan, one for each of
/// them.
std::vector<ResolvedParameter> resolved_parameters(const ScanPoints& points);
/// The same of a model.
std::vector<ResolvedParameter> resolved_parameters(const std::vector<ModelFile>& points);

}  // namespace rabiline
