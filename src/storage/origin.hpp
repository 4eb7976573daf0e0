#pragma once
// What is read of a file that this program wrote, whatever it holds.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/diagnostics.hpp"
#include "simulation/snapshot.hpp"
#include "storage/storage_error.hpp"

namespace rabiline::hdf5 {
class FileReader;
}

namespace rabiline {

/// Whether a file begins as HDF5 does (HDF5 File Format Specification, section II.A).
bool is_hdf5(const std::filesystem::path&);

/// What a result was made from.
struct Origin {
  std::vector<InputText> inputs;
  std::vector<std::string> changes;  // as options
  KeptTransit transit = KeptTransit::if_small;
  std::uint64_t max_memory = 0;  // [bytes] that its run was given; 0: none was stated
  bool rescanned = false;        // worked out from a flight that was kept
};
/// Throws StorageError where the file is no result of this program, or is damaged.
Origin read_origin(const std::filesystem::path&);
Origin read_origin(const hdf5::FileReader&, const std::filesystem::path&);

/// The digest in the last line of a file. Throws StorageError where the file is damaged, was changed, or
/// names other files.
std::string verified_digest(const std::filesystem::path&);

}  // namespace rabiline
