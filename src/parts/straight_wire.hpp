#pragma once
#include "parts/placement.hpp"
#include "parts/time_factor.hpp"

namespace rabiline {

class SectionBuilder;

/// A straight wire through the place `at` and its offset, across the beam as in the flip region of O. Frisch
/// and E. Segre (Z. Phys. 80, 610 (1933)), along it or between. A wire of finite length leaves out its leads,
/// whose field is not known here: its own has a curl. It stops nothing.
struct StraightWire {
  static constexpr std::string_view kind = "straight_wire",
                                    meaning = "the field of a straight wire through the place `at`";
  static constexpr std::string_view place = "the place that the wire runs through, from the source";
  static constexpr PartTraits traits{.field = true};
  static constexpr std::string_view example = "current: 10 A, reach: 5 cm, radius: 0.5 mm";
  double current = 0;  // [A]
  double reach = 0;    // [m]
  double radius = 0;   // [m]
  UnitVector direction{1, 0, 0};
  std::optional<double> wire_length{};  // [m]
  Offset offset{};
  Tilt tilt{};
  std::optional<TimeFactor> oscillates{};
  bool operator==(const StraightWire&) const = default;
};
template <>
inline constexpr auto parameters<StraightWire> = std::tuple{
    param("current", &StraightWire::current, Dimension::current, range::any, "along the direction"),
    param("reach", &StraightWire::reach, Dimension::length, range::positive,
          "how far from `at` the field is taken on both sides; it falls as one over the distance"),
    param("radius", &StraightWire::radius, Dimension::length, range::positive,
          "of the wire, which the current fills evenly"),
    param("direction", &StraightWire::direction, "of the current; x, across the beam, if omitted",
          UnitVector{1, 0, 0}),
    param("wire_length", &StraightWire::wire_length, Dimension::length, range::positive,
          "of the wire, half on each side of `at`; endless if omitted"),
    param("offset", &StraightWire::offset, "displacement of the wire from the axis", Offset{}),
    param("tilt", &StraightWire::tilt, "how the wire is turned", Tilt{}),
    param("oscillates", &StraightWire::oscillates,
          "frequency and phase with which the whole field swings; it stands if omitted"),
};

void contribute(const StraightWire&, const Placement&, SectionBuilder&);

}  // namespace rabiline
