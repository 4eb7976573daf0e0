#pragma once
// Detectors in a results file.
#include "simulation/result.hpp"
#include "storage/nexus.hpp"

namespace rabiline::nexus {

/// What detectors counted, as /entry/scan, /entry/NAME and others beside it, over the scan's axes, and
/// /entry/instrument. `names` hands out those of /entry.
void write_detectors(const hdf5::GroupWriter& entry, const Result&, const std::vector<Axis>& scan,
                     Names& names);

}  // namespace rabiline::nexus
