#pragma once
// The results of a run as one HDF5 file in NeXus base classes.
#include <cstddef>
#include <filesystem>
#include <vector>

#include "simulation/result.hpp"
#include "storage/storage_error.hpp"

namespace rabiline {

/// Writes the file so that it is there wholly and verified, or not at all and an earlier one is intact.
/// Everything outside /entry/simulation and the attributes of "/" depends on the result only, to the bit.
/// Throws StorageError.
void write_results(const Result&, const std::filesystem::path&);
/// The bytes of such a file.
std::vector<std::byte> image_of(const Result&);

}  // namespace rabiline
