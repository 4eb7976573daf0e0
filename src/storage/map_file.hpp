#pragma once
// Maps of fields in HDF5 files of anybody's.
#include <cstdint>
#include <filesystem>

#include "field/field_map.hpp"
#include "storage/storage_error.hpp"

namespace rabiline {

struct StoredMap {
  MapNodes nodes;
  std::uint64_t digest = 0;  // of all numbers
};

/// Reads one-dimensional `x`, `y`, `z` and `Bx`, `By`, `Bz` over them, or `r`, `z`, `Br`, `Bz`, each with its
/// unit in the attribute `units`. Nothing is allocated before its size was found to be reasonable. Throws
/// StorageError.
StoredMap read_map_file(const std::filesystem::path&);

}  // namespace rabiline
