#pragma once
// Builds an HDF5 file in memory, then puts it on the disk in one safe step.
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/hdf5_handles.hpp"

namespace rabiline::hdf5 {

/// Lengths of the dimensions, slowest first; none for a scalar.
using Shape = std::vector<std::size_t>;
using Attributes = std::vector<std::pair<std::string, std::string>>;

/// One group of a file that is being built. Datasets other than scalars are compressed and carry a checksum.
class GroupWriter {
 public:
  GroupWriter(Handle group, std::string file, std::string path);

  /// A new group in this one; `nx_class` may be empty.
  GroupWriter group(const std::string& name, std::string_view nx_class) const;

  void attribute(const std::string& name, std::string_view value) const;
  void attribute(const std::string& name, const std::vector<std::string>& values) const;
  void attribute(const std::string& name, std::uint64_t value) const;

  void dataset(const std::string& name, const Shape&, std::span<const double>, const Attributes& = {}) const;
  void dataset(const std::string& name, const Shape&, std::span<const std::uint64_t>,
               const Attributes& = {}) const;
  void dataset(const std::string& name, const Shape&, std::span<const std::string>,
               const Attributes& = {}) const;
  void text(const std::string& name, const std::string& value, const Attributes& = {}) const;
  void number(const std::string& name, double value, const Attributes& = {}) const;
  void number(const std::string& name, std::uint64_t value, const Attributes& = {}) const;

  /// A second name, in this group, for what stands at an absolute path.
  void link(const std::string& name, const std::string& target) const;

 private:
  struct Elements {
    hid_t memory_type, file_type;
    std::size_t size, count;
    const void* data;
  };
  void write(const std::string& name, const Shape&, const Elements&, const Attributes&) const;
  std::string where(const std::string& name) const;

  Handle group_;
  std::string file_, path_;
};

/// What a file is called that is no file but its bytes.
inline constexpr const char* in_memory = "memory";

class FileWriter {
 public:
  explicit FileWriter(std::filesystem::path target);

  /// The group "/". Groups must be gone before the file is saved.
  GroupWriter root();
  /// What it takes so far [bytes].
  std::size_t size() const;
  /// Its bytes, without a seal.
  std::vector<std::byte> image() const;
  /// Puts the file in its place with its seal (seal.hpp), safely, and reads it back before it replaces
  /// another.
  void save() const;

 private:
  std::filesystem::path target_;
  Handle file_;
};

}  // namespace rabiline::hdf5
