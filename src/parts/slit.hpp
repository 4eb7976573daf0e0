#pragma once
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// A plate of no thickness with one opening: what misses the opening stops there.
struct Slit {
  static constexpr std::string_view kind = "slit",
                                    meaning = "a thin plate with one opening: a rectangle, a disc or a ring";
  static constexpr PartTraits traits{.target = true};
  Opening opening;
  Offset offset;
  Roll tilt{};
  bool operator==(const Slit&) const = default;
};
template <>
inline constexpr auto parameters<Slit> = std::tuple{
    param("", &Slit::opening,
          "the hole: width and height, or radius, or inner and outer radius"),  // its keys stand beside `at`
    param("offset", &Slit::offset, "displacement of the opening's centre from the axis", Offset{}),
    param("tilt", &Slit::tilt, "how the opening is turned in its plane", Roll{}),
};

void contribute(const Slit&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const Slit&, const Placement&);

}  // namespace rabiline
