#pragma once
// Where particles start: an opening in the plane y = 0, laws of speeds and directions, spins and times.
#include <optional>
#include <variant>

#include "particle/direction.hpp"
#include "particle/opening.hpp"
#include "particle/speed.hpp"
#include "particle/start.hpp"

namespace rabiline {

/// Places are independent normal variables about the centre.
struct GaussianSpot {
  static constexpr std::string_view kind = "gaussian_spot",
                                    meaning = "a spot without edge, normal in x and in z";
  double sigma_x = 0;  // [m]
  double sigma_z = 0;  // [m]
  bool operator==(const GaussianSpot&) const = default;
};
template <>
inline constexpr auto parameters<GaussianSpot> = std::tuple{
    param("sigma_x", &GaussianSpot::sigma_x, Dimension::length, range::not_negative,
          "standard deviation along x"),
    param("sigma_z", &GaussianSpot::sigma_z, Dimension::length, range::not_negative,
          "standard deviation along z"),
};
using SourceOpening = std::variant<Rectangle, Disc, Ring, GaussianSpot>;
template <>
inline constexpr std::string_view tag_key<SourceOpening> = "";  // told apart by their keys

/// How the axis of the directions is turned; the opening stays in the plane y = 0.
struct SourceTilt {
  double x = 0, z = 0;  // [rad] about x, then about z, each right-handed
  bool operator==(const SourceTilt&) const = default;
};
template <>
inline constexpr auto parameters<SourceTilt> = std::tuple{
    param("x", &SourceTilt::x, Dimension::angle, range::any,
          "first turn, about x: the beam from +y towards +z", 0.0),
    param("z", &SourceTilt::z, Dimension::angle, range::any,
          "second turn, about z: from +x towards +y, so the beam from +y towards -x", 0.0),
};

struct Source {
  SpeedLaw speed;
  SourceOpening opening;
  DirectionLaw direction;
  Offset offset{};
  SourceTilt tilt{};
  StartSpin spin = UnpolarisedSpin{};
  std::optional<Pulse> pulse{};
  std::optional<double> rate{};  // [1/s] particles that leave the opening
  bool operator==(const Source&) const = default;
};
template <>
inline constexpr auto parameters<Source> = std::tuple{
    param("speed", &Source::speed, "law of speeds"),
    param("opening", &Source::opening, "the hole that particles start from, at y = 0"),
    param("direction", &Source::direction, "law of directions"),
    param("offset", &Source::offset, "displacement of the opening's centre from the axis", Offset{}),
    param("tilt", &Source::tilt, "how the axis of the directions is turned: first about x, then about z",
          SourceTilt{}),
    param("spin", &Source::spin, "the spin that particles start with", UnpolarisedSpin{}),
    param("pulse", &Source::pulse,
          "when particles start, and so the phase at which a locked field meets them; all start at t = 0 "
          "if omitted"),
    param("rate", &Source::rate, Dimension::rate, range::positive,
          "particles that leave the opening in all, per second: turns counts into counts per second"),
};

}  // namespace rabiline
