#pragma once
#include <array>
#include <cstdint>

#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// Numbers of bins along x and z.
struct Bins {
  std::int64_t x = 1;
  std::int64_t z = 1;
  bool operator==(const Bins&) const = default;
};

/// A rectangular screen that catches what hits it and histograms x and z; what misses it flies on.
struct Detector {
  static constexpr std::string_view kind = "detector",
                                    meaning = "a screen that catches particles and histograms x and z";
  double width = 0;   // [m] along x
  double height = 0;  // [m] along z
  Bins bins;
  Offset offset;
  bool operator==(const Detector&) const = default;
};
template <>
inline constexpr auto parameters<Detector> = std::tuple{
    param("width", &Detector::width, Dimension::length, range::positive, "full extent along x"),
    param("height", &Detector::height, Dimension::length, range::positive, "full extent along z"),
    param("bins", &Detector::bins, "numbers of bins along x and z, e.g. [80, 80]; 1 to 10000 each"),
    param("offset", &Detector::offset, "displacement of the screen's centre from the axis", Offset{}),
};

void contribute(const Detector&, const Placement&, SectionBuilder&);

}  // namespace rabiline
