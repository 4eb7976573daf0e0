#pragma once
// /entry/parameters: what was flown, in numbers.
#include "simulation/result.hpp"
#include "storage/hdf5_writer.hpp"

namespace rabiline::nexus {

/// What differs between the points of a scan is a dataset of its own.
void write_parameters(const hdf5::GroupWriter& entry, const std::vector<ResolvedParameter>&);

}  // namespace rabiline::nexus
