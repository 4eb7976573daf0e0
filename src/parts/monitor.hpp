#pragma once
#include "parts/placement.hpp"
#include "tally/tally.hpp"

namespace rabiline {

class SectionBuilder;

/// A plane that counts what passes its face and leaves it as it is, spins included.
struct Monitor {
  static constexpr std::string_view kind = "monitor",
                                    meaning = "counts what passes through its face and stops nothing";
  Face face;
  Offset offset;
  Roll tilt{};
  std::vector<Tally> tallies{};
  bool operator==(const Monitor&) const = default;
};
template <>
inline constexpr auto parameters<Monitor> = std::tuple{
    param("", &Monitor::face, "its size: width and height, or radius"),
    param("offset", &Monitor::offset, "displacement of its centre from the axis", Offset{}),
    param("tilt", &Monitor::tilt, "how the face is turned in its plane", Roll{}),
    param("tallies", &Monitor::tallies, "histograms of what passes (see `describe tallies`)", NoTallies{}),
};

void contribute(const Monitor&, const Placement&, SectionBuilder&);

}  // namespace rabiline
