#pragma once
// What a deflecting magnet does to one species, in words.
#include <string>
#include <vector>

#include "core/fault.hpp"
#include "transport/stages.hpp"

namespace rabiline {

struct MagnetText {
  std::vector<std::string> lines;  // behind "up to where it deflects", without indentation
  std::vector<Fault> warnings;
};

MagnetText text_of(const Deflection&, const std::string& name, double speed);

/// What enters a magnet along the beam's axis; `levels` that it may be in, none where nothing is known of it.
struct OnAxis {
  std::vector<int> levels{};
  double fastest = 0;  // [m/s]
};
MagnetText text_of(const Steering&, const std::string& name, double speed, const OnAxis&);

}  // namespace rabiline
