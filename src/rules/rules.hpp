#pragma once
// What a beamline must keep to, whether it comes from a file or from a program. Rules of one part stand
// beside the part; here are those between parts, source, species and law.
#include <optional>
#include <string_view>
#include <vector>

#include "beamline/experiment.hpp"
#include "core/fault.hpp"

namespace rabiline {

/// Everything that is wrong with a beamline; nothing of it may be planned then.
std::vector<Fault> faults_of(const Beamline&);

/// What is wrong with a scan as a whole, each of whose points is well.
std::vector<Fault> faults_of_scan(const Experiment&);

/// What may not change along an axis of a scan, at `points`; none where all is well. Its subject is empty.
std::optional<Fault> fault_of_axis(std::string_view parameter, const ScanPoints& points);

}  // namespace rabiline
