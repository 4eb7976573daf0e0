#pragma once
#include "parts/placement.hpp"
#include "tally/tally.hpp"

namespace rabiline {

class SectionBuilder;

/// A plane, or several of equal distance, that counts what passes its face and leaves it as it is, spins
/// included.
struct Monitor {
  static constexpr std::string_view
      kind = "monitor",
      meaning =
          "counts what passes through its face and stops nothing; inside of fields that turn the "
          "velocity each particle once, where it flies through for the first time";
  static constexpr std::string_view place = "where its plane is, or the first of several, from the source";
  static constexpr PartTraits traits{};
  Face face;
  Offset offset;
  Roll tilt{};
  std::vector<Tally> tallies{};
  double length = 0;  // [m] from the first plane to the last
  std::uint64_t planes = 1;
  bool operator==(const Monitor&) const = default;
};
inline constexpr Range monitor_planes{1, 1000, true, true, "from 1 to 1000"};
template <>
inline constexpr auto parameters<Monitor> = std::tuple{
    param("", &Monitor::face, "its size: width and height, or radius"),
    param("offset", &Monitor::offset, "displacement of its centre from the axis", Offset{}),
    param("tilt", &Monitor::tilt, "how the face is turned in its plane", Roll{}),
    param("tallies", &Monitor::tallies, "histograms of what passes (see `describe tallies`)", NoTallies{}),
    param("length", &Monitor::length, Dimension::length, range::not_negative,
          "from its first plane to its last, which `planes` counts", 0.0),
    param(
        "planes", &Monitor::planes, Dimension::number, monitor_planes,
        "of equal distance, each counted for itself: `y` is then the first axis of what it counts and of its "
        "tallies",
        std::uint64_t{1}),
};

/// Where its planes are [m], counted from 0.
double place_of_plane(const Monitor&, const Placement&, std::size_t plane);

void contribute(const Monitor&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const Monitor&, const Placement&);

}  // namespace rabiline
