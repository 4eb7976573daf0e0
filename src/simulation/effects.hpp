#pragma once
// What a result shows of its scan.
#include <cstdint>
#include <string>
#include <vector>

#include "simulation/result.hpp"

namespace rabiline {

/// Remembers of each scan point a digest of all that detectors, monitors and tallies saw, so that points can
/// be compared that are not in memory any more.
class Effects {
 public:
  /// The next points, row-major.
  void add(const Result& points);
  /// One text, with its help in a further line, for each axis whose points agree to the bit: what is scanned
  /// there had no effect; for flights in steps that are off; and where nothing was detected.
  std::vector<std::string> warnings(const Result&) const;

 private:
  bool anything_ = false;  // was there to see
  bool detected_ = false;  // anything, at any point
  std::vector<std::uint64_t> seen_;
};

}  // namespace rabiline
