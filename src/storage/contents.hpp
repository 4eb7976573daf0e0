#pragma once
// Whether a file holds what another one would.
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "storage/storage_error.hpp"

namespace rabiline {

/// The paths of what a file of this program holds otherwise than another one, given by its bytes, or alone:
/// another type, shape, value or attribute. All is compared but how, where, when and by which version of the
/// program it was computed, and a flight that only one of them has kept. Throws StorageError where the file
/// is damaged.
std::vector<std::string> differing(const std::filesystem::path&, std::span<const std::byte> image);

}  // namespace rabiline
