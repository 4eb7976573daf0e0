#pragma once
#include <array>
#include <cstdint>

#include "parts/placement.hpp"
#include "tally/tally.hpp"

namespace rabiline {

class SectionBuilder;

/// Numbers of bins along x and z.
struct Bins {
  std::int64_t x = 1;
  std::int64_t z = 1;
  bool operator==(const Bins&) const = default;
};

/// A part of a screen that absorbs and does not count.
struct DeadArea {
  Face face;
  Offset offset;
  bool operator==(const DeadArea&) const = default;
};
template <>
inline constexpr auto parameters<DeadArea> = std::tuple{
    param("", &DeadArea::face, "its size: width and height, or radius"),
    param("offset", &DeadArea::offset,
          "displacement of its centre from the screen's, along the screen's own x and z", Offset{}),
};

/// A screen that catches what hits it and histograms x and z; what misses it flies on. Of the weight of what
/// it catches it counts `efficiency`, rounded down to quanta, and nothing inside its dead area; the rest is
/// stopped there uncounted.
struct Detector {
  static constexpr std::string_view kind = "detector",
                                    meaning =
                                        "a screen that catches particles and histograms x and z; a hot wire "
                                        "is one of small width";
  static constexpr std::string_view place = "where the screen is, from the source";
  static constexpr PartTraits traits{.target = true};
  Face face;
  Bins bins;
  Offset offset;
  Roll tilt{};
  double efficiency = 1;
  std::optional<DeadArea> dead{};
  double background = 0;  // [1/s]
  std::vector<Tally> tallies{};
  bool operator==(const Detector&) const = default;
};
template <>
inline constexpr auto parameters<Detector> = std::tuple{
    param("", &Detector::face, "its size: width and height, or radius"),
    param("bins", &Detector::bins, "numbers of bins along x and z, e.g. [80, 80]; 1 to 10000 each"),
    param("offset", &Detector::offset, "displacement of the screen's centre from the axis", Offset{}),
    param(
        "tilt", &Detector::tilt,
        "how the screen is turned about its centre, its +z towards +x and its +x towards -z; x and z of its "
        "histogram turn with it",
        Roll{}),
    param("efficiency", &Detector::efficiency, Dimension::number, range::fraction,
          "share of the weight that is counted; the rest is stopped there uncounted", 1.0),
    param("dead", &Detector::dead,
          "an area of the face inside which nothing is counted, which moves and turns with it; none if "
          "omitted"),
    param("background", &Detector::background, Dimension::rate, range::not_negative,
          "counts per second without a beam, carried to the results", 0.0),
    param("tallies", &Detector::tallies, "histograms of what is counted (see `describe tallies`)",
          NoTallies{}),
};

void contribute(const Detector&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const Detector&, const Placement&);

}  // namespace rabiline
