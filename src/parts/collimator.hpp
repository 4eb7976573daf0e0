#pragma once
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// A straight channel with absorbing walls. A straight flight that is inside a convex opening at both ends
/// never touches it between, a parabola may; in fields that turn the path it is a wall all along.
struct Collimator {
  static constexpr std::string_view kind = "collimator",
                                    meaning = "a straight channel of some length with absorbing walls";
  static constexpr PartTraits traits{};
  double length = 0;  // [m]
  Face opening;
  Offset offset{};
  Roll tilt{};
  bool operator==(const Collimator&) const = default;
};
template <>
inline constexpr auto parameters<Collimator> = std::tuple{
    param("length", &Collimator::length, Dimension::length, range::positive, "extent along the beam"),
    param("", &Collimator::opening,
          "the channel: width and height, or radius"),  // its keys stand beside `at`
    param("offset", &Collimator::offset, "displacement of the channel's centre from the axis", Offset{}),
    param("tilt", &Collimator::tilt, "how the opening is turned in its plane", Roll{}),
};

void contribute(const Collimator&, const Placement&, SectionBuilder&);

}  // namespace rabiline
