#pragma once
// Builds an HDF5 file in memory, or beside its place on the disk, then puts it there in one safe step.
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
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

/// The shape of a dataset over scan points: what stands in front of them, their grid, what stands behind.
struct OverPoints {
  Shape before, grid, behind;
};

/// The scan points that are written now, row-major, and how many there are in all.
struct Slab {
  std::size_t first = 0, count = 1, all = 1;
  bool is_whole() const { return count == all; }
};
/// What groups of one file share. Datasets over points stay open until the last slab, as chunks that are half
/// full would be packed and unpacked for each.
struct SlabWriting {
  Slab slab;
  std::map<std::string, Handle> open{};
};

/// One group of a file that is being built. Datasets other than scalars are compressed and carry a checksum.
/// Behind the first slab nothing is written but datasets over points: the rest is there.
class GroupWriter {
 public:
  GroupWriter(Handle group, std::string file, std::string path, SlabWriting& slabs);

  /// Whether nothing is written but datasets over points.
  bool goes_on() const { return slabs_->slab.first > 0; }
  /// A group in this one; `nx_class` may be empty.
  GroupWriter group(const std::string& name, std::string_view nx_class) const;

  void attribute(const std::string& name, std::string_view value) const;
  void attribute(const std::string& name, const std::vector<std::string>& values) const;
  void attribute(const std::string& name, std::uint64_t value) const;

  void dataset(const std::string& name, const Shape&, std::span<const double>, const Attributes& = {}) const;
  void dataset(const std::string& name, const Shape&, std::span<const std::uint64_t>,
               const Attributes& = {}) const;
  void dataset(const std::string& name, const Shape&, std::span<const std::string>,
               const Attributes& = {}) const;
  /// `values` are of the points of the slab: [before][points][behind].
  void over_points(const std::string& name, const OverPoints&, std::span<const double> values,
                   const Attributes& = {}) const;
  void over_points(const std::string& name, const OverPoints&, std::span<const std::uint64_t> values,
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
  static Elements elements_of(std::span<const double>);
  static Elements elements_of(std::span<const std::uint64_t>);
  Handle create(const std::string& name, const Shape&, const Elements&, const Attributes&,
                const Handle& access) const;
  void write(const std::string& name, const Shape&, const Elements&, const Attributes&) const;
  void write_points(const std::string& name, const OverPoints&, const Elements&, const Attributes&) const;
  std::string where(const std::string& name) const;

  Handle group_;
  std::string file_, path_;
  SlabWriting* slabs_;
};

/// What a file is called that is no file but its bytes.
inline constexpr const char* in_memory = "memory";

class DiskFile;

class FileWriter {
 public:
  /// In memory until it is saved, or in a file beside `target`.
  enum class Place { memory, disk };
  explicit FileWriter(std::filesystem::path target, Place = Place::memory);
  FileWriter(FileWriter&&) noexcept;
  ~FileWriter();

  /// The group "/". Groups must be gone before the file is saved.
  GroupWriter root();
  /// What groups are given from now on is of these points, which follow those before.
  void turn_to(const Slab&);
  /// Throws StorageError where something could not be written so far.
  void require_written() const;
  /// All points are there.
  void end_slabs();
  /// What it takes so far [bytes].
  std::size_t size() const;
  /// Its bytes, without a seal.
  std::vector<std::byte> image() const;
  /// Puts the file in its place with its seal (seal.hpp), safely, and reads it back before it replaces
  /// another.
  void save();

 private:
  std::filesystem::path target_;
  std::unique_ptr<DiskFile> disk_;  // none where the file is in memory
  Handle file_;
  std::unique_ptr<SlabWriting> slabs_ = std::make_unique<SlabWriting>();
};

}  // namespace rabiline::hdf5
