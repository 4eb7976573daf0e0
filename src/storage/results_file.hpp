#pragma once
// The results of a run as one HDF5 file in NeXus base classes.
#include <cstddef>
#include <filesystem>
#include <memory>
#include <vector>

#include "simulation/result.hpp"
#include "storage/storage_error.hpp"

namespace rabiline {

/// A file of results that gets the points of a scan slab by slab, row-major, so that no more than one slab of
/// them need be in memory. It is there once it is saved: wholly and verified, or not at all and an earlier
/// one is intact. Everything outside /entry/simulation and the attributes of "/" depends on the result only,
/// to the bit. Throws StorageError.
class ResultsFile {
 public:
  explicit ResultsFile(std::filesystem::path);
  ResultsFile(const ResultsFile&) = delete;
  ResultsFile& operator=(const ResultsFile&) = delete;
  ~ResultsFile();

  /// The next points. Their axes are those of the whole scan.
  void add(const Result& points);
  /// What is not of single points, and the texts of all of them.
  void save(const Result& rest);

  struct Contents;  // known to the writer alone

 private:
  std::unique_ptr<Contents> contents_;
};

/// A result in one piece.
void write_results(const Result&, const std::filesystem::path&);
/// The bytes of such a file.
std::vector<std::byte> image_of(const Result&);

}  // namespace rabiline
