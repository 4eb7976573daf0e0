#pragma once
// The last line of every file that this program writes: a digest of all that stands before it. It tells of
// accidents and of changes by others; it does not stop a forger.
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "storage/storage_error.hpp"

namespace rabiline {

/// "\nrabiline: SHA-256 of all before this line: 64 digits\n"
std::string seal_of(std::span<const std::byte> content);

std::string seal_of(const std::filesystem::path& file);

/// Reads a file once from end to end, so that HDF5 never sees a damaged one. Returns its digest; throws
/// StorageError where the file is not what this program wrote, to the bit.
std::string require_seal(const std::filesystem::path&);

}  // namespace rabiline
