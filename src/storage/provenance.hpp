#pragma once
// Where a result comes from: /entry/simulation.
#include "simulation/result.hpp"
#include "storage/hdf5_writer.hpp"

namespace rabiline::nexus {

/// A new group `simulation` with program, machine, times, command line and input texts, and the digest of
/// what the file holds besides (Origin).
hdf5::GroupWriter write_provenance(const hdf5::GroupWriter& entry, const Provenance&, std::uint64_t content);

}  // namespace rabiline::nexus
