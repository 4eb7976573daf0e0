#pragma once
// Snapshots on disk, so that a run that was killed goes on with the same bits.
// The same file holds the sums of a shard.
#include <filesystem>

#include "simulation/snapshot.hpp"
#include "storage/storage_error.hpp"

namespace rabiline {

/// Writes the file wholly and verified, or throws StorageError and leaves an earlier one intact.
void write_checkpoint(const Snapshot&, const std::filesystem::path&);

/// Reads what write_checkpoint wrote. Throws StorageError where the file is damaged in any way or is no
/// checkpoint. A file that somebody forged is refused before it opens other files or fills the memory;
/// against metadata forged to crash HDF5 itself there is no defence here.
Snapshot read_checkpoint(const std::filesystem::path&);

}  // namespace rabiline
