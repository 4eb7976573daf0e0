#pragma once
#include "parts/coil_strength.hpp"
#include "parts/placement.hpp"
#include "parts/time_factor.hpp"

namespace rabiline {

class SectionBuilder;

/// A thin ring of current with its centre at `at`: B in closed form by complete elliptic integrals
/// (field/current_loop.hpp). It stops nothing.
struct CurrentLoop {
  static constexpr std::string_view kind = "current_loop",
                                    meaning = "the field of a ring of current whose centre is at `at`";
  static constexpr std::string_view place = "the centre of the ring, from the source";
  static constexpr PartTraits traits{.field = true};
  static constexpr std::string_view example = "radius: 50 mm, current: 10 A, turns: 20";
  double radius = 0;  // [m]
  CoilStrength strength;
  UnitVector direction{0, 1, 0};
  std::optional<double> reach{};  // [m]
  Offset offset{};
  Tilt tilt{};
  std::optional<TimeFactor> oscillates{};
  bool operator==(const CurrentLoop&) const = default;
};
template <>
inline constexpr auto parameters<CurrentLoop> = std::tuple{
    param("radius", &CurrentLoop::radius, Dimension::length, range::positive, "of the ring"),
    param("", &CurrentLoop::strength, "the current, or the field in the middle"),
    param("direction", &CurrentLoop::direction, "of the field in the middle; the beam's if omitted",
          UnitVector{0, 1, 0}),
    param("reach", &CurrentLoop::reach, Dimension::length, range::positive,
          "how far the field is taken on both sides; if omitted, up to 1e-4 of its largest"),
    param("offset", &CurrentLoop::offset, "displacement of the centre from the axis", Offset{}),
    param("tilt", &CurrentLoop::tilt, "how the ring is turned about its centre", Tilt{}),
    param("oscillates", &CurrentLoop::oscillates,
          "frequency and phase with which the whole field swings; it stands if omitted"),
};

void contribute(const CurrentLoop&, const Placement&, SectionBuilder&);

/// [m] from a ring, along its axis, to where its field is 1e-4 of that in its middle: 21.5 radii.
double reach_of_loop(double radius);

}  // namespace rabiline
