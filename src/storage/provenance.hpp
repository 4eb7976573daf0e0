#pragma once
// Where a result comes from: /entry/simulation.
#include "simulation/result.hpp"
#include "storage/hdf5_writer.hpp"

namespace rabiline::nexus {

/// A new group `simulation` with program, machine, times, command line and input texts.
hdf5::GroupWriter write_provenance(const hdf5::GroupWriter& entry, const Provenance&);

}  // namespace rabiline::nexus
