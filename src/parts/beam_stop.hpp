#pragma once
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// Stops what hits its shape; what misses it flies on.
struct BeamStop {
  static constexpr std::string_view kind = "beam_stop",
                                    meaning = "stops what hits its shape, a plate or a disc";
  static constexpr PartTraits traits{};
  Opening shape;
  Offset offset{};
  Roll tilt{};
  bool operator==(const BeamStop&) const = default;
};
template <>
inline constexpr auto parameters<BeamStop> = std::tuple{
    param(
        "", &BeamStop::shape,
        "what stops: width and height, or radius, or inner and outer radius"),  // its keys stand beside `at`
    param("offset", &BeamStop::offset, "displacement of its centre from the axis", Offset{}),
    param("tilt", &BeamStop::tilt, "how it is turned in its plane", Roll{}),
};

void contribute(const BeamStop&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const BeamStop&, const Placement&);

}  // namespace rabiline
