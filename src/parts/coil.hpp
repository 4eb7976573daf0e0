#pragma once
#include "particle/speed.hpp"
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// A static field that turns spins by an angle about an axis at one speed, right-handed: field
/// -angle speed/(gamma length) along the axis, gamma that of the beam's first species. Faster particles turn
/// less. It adds to the fields that it stands in.
struct Coil {
  static constexpr std::string_view
      kind = "coil",
      meaning = "a static field that turns spins by an angle at one speed: a pi/2 or a pi coil";
  static constexpr PartTraits traits{.field = true, .sets_spins = true};
  double length = 0;  // [m]
  UnitVector axis{};
  double angle = 0;     // [rad] right-handed about the axis
  SpeedQuantity speed;  // at which the spin turns by the angle
  std::optional<Bore> bore;
  Offset offset{};
  Tilt tilt{};
  bool operator==(const Coil&) const = default;
};
template <>
inline constexpr auto parameters<Coil> = std::tuple{
    param("length", &Coil::length, Dimension::length, range::positive, "extent along the beam"),
    param("axis", &Coil::axis, "axis that the spin turns about"),
    param("angle", &Coil::angle, Dimension::angle, range::any,
          "by which the spin turns, right-handed about the axis"),
    param("speed", &Coil::speed, Dimension::speed, range::positive,
          "along the beam, of a particle that turns by the angle"),
    param("bore", &Coil::bore, "wall around the field; none if omitted"),
    param("offset", &Coil::offset, "displacement of the bore's centre from the axis", Offset{}),
    param("tilt", &Coil::tilt, "how the field is turned inside its slab", Tilt{}),
};

void contribute(const Coil&, const Placement&, SectionBuilder&);

}  // namespace rabiline
