#pragma once
// Trajectories as one HDF5 file in NeXus base classes: one plot of x against y per particle.
#include <cstddef>
#include <filesystem>
#include <vector>

#include "simulation/result.hpp"
#include "storage/storage_error.hpp"

namespace rabiline {

/// Writes the file wholly and verified, or not at all. Throws StorageError.
void write_tracks(const Tracks&, const std::filesystem::path&);
/// The bytes of such a file.
std::vector<std::byte> image_of(const Tracks&);

}  // namespace rabiline
