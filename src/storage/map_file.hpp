#pragma once
// Maps of fields in HDF5 files of anybody's.
#include <filesystem>

#include "field/field_map.hpp"
#include "storage/storage_error.hpp"

namespace rabiline {

/// Reads one-dimensional `x`, `y`, `z` and `Bx`, `By`, `Bz` over them, or `r`, `z`, `Br`, `Bz`, each with its
/// unit in the attribute `units`. Nothing is allocated before its size was found to be reasonable. Throws
/// StorageError.
MapNodes read_map_file(const std::filesystem::path&);

}  // namespace rabiline
