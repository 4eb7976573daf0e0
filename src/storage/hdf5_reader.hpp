#pragma once
// Reads HDF5 files that may come from anybody: nothing outside the file is opened, nothing is allocated
// before its size was found to be reasonable.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "storage/hdf5_handles.hpp"

namespace rabiline::hdf5 {

/// Who wrote a file: this program, with its seal (seal.hpp), or anybody.
enum class Writer { rabiline, anybody };

class FileReader {
 public:
  /// Throws StorageError where the file is not what this program wrote, or names any other file.
  explicit FileReader(const std::filesystem::path&, Writer = Writer::rabiline);
  /// The bytes of a file that this program has made (FileWriter::image).
  explicit FileReader(std::span<const std::byte> image);

  /// One-dimensional datasets by their paths, written by GroupWriter. Throws StorageError where the
  /// dataset is missing, is of another kind, is larger than the limit, or lies outside the file in any way.
  std::vector<std::uint64_t> numbers(const std::string& name, std::size_t most_numbers) const;
  std::vector<double> reals(const std::string& name, std::size_t most_numbers) const;
  /// Real numbers of 32 or 64 bits: a row of any length up to a limit, or a box of these sizes.
  std::vector<double> reals_of_any_size(const std::string& name, std::size_t most_numbers) const;
  std::vector<double> grid(const std::string& name, const std::vector<std::size_t>& sizes) const;
  /// A text beside a dataset, up to 64 bytes.
  std::string attribute(const std::string& dataset, const char* name) const;
  std::vector<std::string> texts(const std::string& name, std::size_t most_bytes) const;
  /// One text.
  std::string text(const std::string& name, std::size_t most_bytes) const;
  bool contains(const std::string& name) const;
  /// The paths of all groups and datasets, without the slash before them, sorted.
  const std::vector<std::string>& names() const { return names_; }
  /// What is under a name, as bytes: whether it is a group, its attributes, and of a dataset the type, the
  /// shape and the values. Throws StorageError where that is nothing that this program writes. `but`: names
  /// of attributes that do not count.
  std::string everything(const std::string& name, std::span<const std::string_view> but = {}) const;
  /// Of the whole file, by its seal.
  const std::string& digest() const { return digest_; }

 private:
  template <class Number>
  std::vector<Number> numbers_of(const std::string& name, std::size_t most, hid_t file_type,
                                 hid_t memory_type, std::string_view kind) const;
  void find_names();
  /// HDF5 follows the references of texts of any length to wherever a damaged file makes them point, and has
  /// no check of its own: whether all of them can be read, which a process of its own tries once; where it
  /// does not end well, each is tried before it is read.
  bool texts_are_sound() const;
  Handle open_dataset(const std::string& name) const;
  std::string where(const std::string& name) const;

  std::string file_name_, digest_;
  Handle file_;
  std::vector<std::string> names_;
  mutable std::optional<bool> texts_are_sound_;
};

}  // namespace rabiline::hdf5
