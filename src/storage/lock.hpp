#pragma once
// One process at a time for each output.
#include <filesystem>
#include <optional>

#include "storage/safe_file.hpp"
#include "storage/storage_error.hpp"

namespace rabiline {

/// Keeps other processes from an output while it lives, by a lock on the hidden file .NAME.lock beside it,
/// which a kill -9 leaves behind without its lock. Throws StorageError, which names the process that has it,
/// and where the hidden file is none of ours. File systems without locks have none.
class Lock {
 public:
  explicit Lock(const std::filesystem::path& output);
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  ~Lock();

 private:
  std::filesystem::path path_;
  std::optional<PassingFile> passing_{};
  int descriptor_ = -1;
};

}  // namespace rabiline
