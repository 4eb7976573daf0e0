#pragma once
// Monitors and tallies in a results file.
#include "simulation/result.hpp"
#include "storage/nexus.hpp"

namespace rabiline::nexus {

/// Monitors as /entry/NAME and tallies as /entry/PART_NAME, over the scan's axes. `names` hands out those of
/// /entry.
void write_monitors_and_tallies(const hdf5::GroupWriter& entry, const Result&, const std::vector<Axis>& scan,
                                Names& names);

/// The middle of each bin.
std::vector<double> centres_of(const std::vector<double>& edges);

}  // namespace rabiline::nexus
