#pragma once
// Where particles start: an opening in the plane y = 0, a law of speeds and a law of directions.
#include <string>
#include <variant>

#include "particle/opening.hpp"

namespace rabiline {

struct SingleSpeed {
  static constexpr std::string_view kind = "single", meaning = "every particle has the same speed";
  double value = 0;  // [m/s]
  bool operator==(const SingleSpeed&) const = default;
};
template <>
inline constexpr auto parameters<SingleSpeed> = std::tuple{
    param("value", &SingleSpeed::value, Dimension::speed, range::positive, "the speed"),
};

/// A normal law cut at zero: speeds that are not positive are drawn again.
struct GaussianSpeed {
  static constexpr std::string_view kind = "gaussian", meaning = "a normal law, cut at zero";
  double mean = 0;   // [m/s]
  double sigma = 0;  // [m/s] standard deviation
  bool operator==(const GaussianSpeed&) const = default;
};
template <>
inline constexpr auto parameters<GaussianSpeed> = std::tuple{
    param("mean", &GaussianSpeed::mean, Dimension::speed, range::positive, "mean speed"),
    param("sigma", &GaussianSpeed::sigma, Dimension::speed, range::not_negative, "standard deviation"),
};
using SpeedLaw = std::variant<SingleSpeed, GaussianSpeed>;

struct ParallelDirection {
  static constexpr std::string_view kind = "parallel", meaning = "every particle starts along +y";
  bool operator==(const ParallelDirection&) const = default;
};

/// Slopes dx/dy and dz/dy are independent normal variables.
struct GaussianDirection {
  static constexpr std::string_view kind = "gaussian", meaning = "normally distributed slopes";
  double x = 0;  // [rad] standard deviation of the slope dx/dy
  double z = 0;  // [rad] of dz/dy
  bool operator==(const GaussianDirection&) const = default;
};
template <>
inline constexpr auto parameters<GaussianDirection> = std::tuple{
    param("x", &GaussianDirection::x, Dimension::angle, range::not_negative,
          "standard deviation of the slope dx/dy"),
    param("z", &GaussianDirection::z, Dimension::angle, range::not_negative,
          "standard deviation of the slope dz/dy"),
};

/// Uniform in solid angle inside a cone around +y.
struct ConeDirection {
  static constexpr std::string_view kind = "cone",
                                    meaning = "uniform in solid angle inside a cone around the beam";
  double half_angle = 0;  // [rad]
  bool operator==(const ConeDirection&) const = default;
};
template <>
inline constexpr auto parameters<ConeDirection> = std::tuple{
    param("half_angle", &ConeDirection::half_angle, Dimension::angle, range::below_right_angle,
          "angle between the axis and the rim of the cone"),
};

/// An isotropic source of which only the particles towards one opening are drawn. Each carries the weight
/// cos^3(theta); the solid angle area/distance^2 of that opening stays a factor in the result.
struct AimedDirection {
  static constexpr std::string_view kind = "aimed",
                                    meaning = "isotropic, but only towards one opening downstream";
  std::string target;  // name of a slit or detector
  bool operator==(const AimedDirection&) const = default;
};
template <>
inline constexpr auto parameters<AimedDirection> = std::tuple{
    param("target", &AimedDirection::target, "name of the slit or detector that the source is aimed at"),
};
using DirectionLaw = std::variant<ParallelDirection, GaussianDirection, ConeDirection, AimedDirection>;

struct Source {
  SpeedLaw speed;
  Opening opening;
  DirectionLaw direction;
  bool operator==(const Source&) const = default;
};
template <>
inline constexpr auto parameters<Source> = std::tuple{
    param("speed", &Source::speed, "law of speeds"),
    param("opening", &Source::opening, "the hole that particles start from, centred on the axis at y = 0"),
    param("direction", &Source::direction, "law of directions"),
};

}  // namespace rabiline
