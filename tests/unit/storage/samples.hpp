#pragma once
// Results, tracks and snapshots to write, and a folder to write them in.
#include <filesystem>
#include <string>
#include <vector>

#include "simulation/result.hpp"
#include "simulation/snapshot.hpp"

namespace rabiline::samples {

/// A folder of its own for each test, removed with everything in it.
class Folder {
 public:
  Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder();
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }
  /// Names of all files in it, hidden ones too, sorted.
  std::vector<std::string> names() const;

 private:
  std::filesystem::path path_;
};

std::string bytes_of(const std::filesystem::path&);
void put_bytes(const std::filesystem::path&, const std::string&);

/// A scan over these axes; every number differs from every other, so that a wrong order shows.
Result result(std::vector<ScanAxis> axes, std::vector<std::string> detectors);
ScanAxis frequency_axis(std::size_t points);
ScanAxis field_axis(std::size_t points);
ScanAxis law_axis();

std::vector<Track> tracks();

Snapshot snapshot(std::uint64_t number, std::size_t sums);
bool same(const Snapshot&, const Snapshot&);

}  // namespace rabiline::samples
