#pragma once
// Where particles start to: laws of directions about the source's axis, which is +y unless it is tilted.
#include <string>
#include <variant>

#include "parameter/parameter.hpp"

namespace rabiline {

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
    param("x", &GaussianDirection::x, Dimension::angle, range::below_right_angle,
          "standard deviation of the slope dx/dy"),
    param("z", &GaussianDirection::z, Dimension::angle, range::below_right_angle,
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

/// Slopes dx/dy and dz/dy are independent and uniform.
struct BoxDirection {
  static constexpr std::string_view kind = "box", meaning = "uniform slopes between two limits";
  double x = 0;  // [rad] the largest |dx/dy|
  double z = 0;  // [rad] the largest |dz/dy|
  bool operator==(const BoxDirection&) const = default;
};
template <>
inline constexpr auto parameters<BoxDirection> = std::tuple{
    param("x", &BoxDirection::x, Dimension::angle, range::below_right_angle,
          "half width: the slope dx/dy is uniform from -x to x"),
    param("z", &BoxDirection::z, Dimension::angle, range::below_right_angle,
          "half width of the slope dz/dy, likewise"),
};

/// Lambert's law, what leaves a thin hole: flux per solid angle ~ cos(theta).
struct CosineDirection {
  static constexpr std::string_view kind = "cosine",
                                    meaning = "what leaves a thin hole of an oven: Lambert's law, cos(theta)";
  double half_angle = 1.5707963267948966;  // [rad] nothing starts beyond
  bool operator==(const CosineDirection&) const = default;
};
template <>
inline constexpr auto parameters<CosineDirection> = std::tuple{
    param("half_angle", &CosineDirection::half_angle, Dimension::angle,
          Range{0, 1.5707963267948966, false, true, "greater than 0 and at most 90 deg"},
          "nothing starts at a larger angle to the axis", 1.5707963267948966),
};

/// What leaves a long round hole of an oven: Clausing (1932); particle/channel.hpp.
struct ChannelDirection {
  static constexpr std::string_view kind = "channel",
                                    meaning = "what leaves a round tube of an oven: Clausing's law";
  double length = 0;  // [m]
  double radius = 0;  // [m]
  bool operator==(const ChannelDirection&) const = default;
};
template <>
inline constexpr auto parameters<ChannelDirection> = std::tuple{
    param("length", &ChannelDirection::length, Dimension::length, range::positive,
          "length of the tube, which ends at y = 0"),
    param("radius", &ChannelDirection::radius, Dimension::length, range::positive,
          "inner radius of the tube"),
};

struct IsotropicEmission {
  static constexpr std::string_view kind = "isotropic",
                                    meaning = "the same in all directions of the forward hemisphere";
  bool operator==(const IsotropicEmission&) const = default;
};
struct CosineEmission {
  static constexpr std::string_view kind = "cosine", meaning = CosineDirection::meaning;
  bool operator==(const CosineEmission&) const = default;
};
using EmissionLaw = std::variant<IsotropicEmission, CosineEmission, ChannelDirection>;

/// Of all that such a source emits only the particles towards one opening are drawn, uniform over it. Each
/// carries the weight g(theta) cos^3(theta), since dOmega = cos^3(theta) dA/D^2, with the law's density per
/// solid angle relative to the axis g = 1 (isotropic), cos(theta) (cosine), j(theta) cos(theta) (channel).
/// What weight 1 stands for stays a factor of the result.
struct AimedDirection {
  static constexpr std::string_view kind = "aimed",
                                    meaning = "only what starts towards one opening downstream";
  std::string target;  // name of a slit or detector
  EmissionLaw emission = IsotropicEmission{};
  bool operator==(const AimedDirection&) const = default;
};
template <>
inline constexpr auto parameters<AimedDirection> = std::tuple{
    param("target", &AimedDirection::target, "name of the slit or detector that the source is aimed at"),
    param("emission", &AimedDirection::emission, "the law of directions of which that is a part",
          IsotropicEmission{}),
};
using DirectionLaw = std::variant<ParallelDirection, GaussianDirection, ConeDirection, AimedDirection,
                                  CosineDirection, BoxDirection, ChannelDirection>;

}  // namespace rabiline
