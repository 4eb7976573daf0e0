#pragma once
// HDF5 on a file that is being made, which is told of no failure: HDF5 1.10 ends the program by a
// segmentation fault, at its end, where a file could not be closed, as on a full disk.
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "storage/hdf5_handles.hpp"
#include "storage/safe_file.hpp"

namespace rabiline::hdf5 {

/// From the first failure on, what is written stays in memory, so that HDF5 reads it back and closes.
class DiskFile {
 public:
  explicit DiskFile(const std::filesystem::path& target) : file_(target) {}
  void write(std::size_t offset, std::span<const std::byte>);
  void read(std::size_t offset, std::span<std::byte>) const;
  void end(std::size_t size) { size_ = size; }
  /// Throws StorageError where something could not be written.
  void require_written() const;
  /// What HDF5 has closed; throws likewise.
  NewFile& closed();

 private:
  NewFile file_;
  std::size_t size_ = 0;
  int error_ = 0;
  std::vector<std::pair<std::size_t, std::vector<std::byte>>> unwritten_;
};

/// Access to such a file, by HDF5's name of it; the file must live until HDF5 has closed it.
Handle access_to(DiskFile&, std::string_view where);

}  // namespace rabiline::hdf5
