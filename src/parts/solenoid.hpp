#pragma once
#include "parts/coil_strength.hpp"
#include "parts/placement.hpp"
#include "parts/time_factor.hpp"

namespace rabiline {

class SectionBuilder;

/// Wire wound evenly and thinly on a cylinder with its middle at `at`: a sheet of current, whose field inside
/// and outside is known in closed form (N. Derby, S. Olbert, Am. J. Phys. 78, 229 (2010)). It stops nothing;
/// where the beam crosses its turns the field is that of the sheet, which jumps.
struct Solenoid {
  static constexpr std::string_view kind = "solenoid",
                                    meaning = "the field of a wound cylinder whose middle is at `at`";
  static constexpr std::string_view place = "the middle of the cylinder, from the source";
  static constexpr PartTraits traits{.field = true};
  static constexpr std::string_view example = "winding: 20 cm, radius: 20 mm, current: 1 A, turns: 400";
  double winding = 0;  // [m]
  double radius = 0;   // [m]
  CoilStrength strength;
  UnitVector direction{0, 1, 0};
  std::optional<double> reach{};  // [m]
  Offset offset{};
  Tilt tilt{};
  std::optional<TimeFactor> oscillates{};
  bool operator==(const Solenoid&) const = default;
};
template <>
inline constexpr auto parameters<Solenoid> = std::tuple{
    param("winding", &Solenoid::winding, Dimension::length, range::positive, "length of the wound cylinder"),
    param("radius", &Solenoid::radius, Dimension::length, range::positive, "of the turns"),
    param("", &Solenoid::strength, "the current, or the field in the middle"),
    param("direction", &Solenoid::direction, "of the field in the middle; the beam's if omitted",
          UnitVector{0, 1, 0}),
    param("reach", &Solenoid::reach, Dimension::length, range::positive,
          "how far from its middle the field is taken on both sides; if omitted, up to 1e-4 of its "
          "largest"),
    param("offset", &Solenoid::offset, "displacement of the middle from the axis", Offset{}),
    param("tilt", &Solenoid::tilt, "how the cylinder is turned about its middle", Tilt{}),
    param("oscillates", &Solenoid::oscillates,
          "frequency and phase with which the whole field swings; it stands if omitted"),
};

void contribute(const Solenoid&, const Placement&, SectionBuilder&);

}  // namespace rabiline
