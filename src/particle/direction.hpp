#pragma once
// Where particles start to: laws of directions about the source's axis, which is +y unless it is tilted.
#include <concepts>
#include <map>
#include <string>
#include <variant>

#include "parameter/parameter.hpp"
#include "particle/draw.hpp"

namespace rabiline {

class LawTables;

/// What the program asks of a distribution of directions about the source's axis.
template <class L>
concept DirectionDistribution = requires(const L& law, double deviations, LawTables& tables) {
  // The word for it in a file, and the line of help that explains it.
  { L::kind } -> std::convertible_to<std::string_view>;
  { L::meaning } -> std::convertible_to<std::string_view>;
  // [rad] The largest angle to the axis; a normal law is taken to end at so many standard deviations.
  { law.widest_angle(deviations) } -> std::same_as<double>;
  // What kernels draw with; tables that they read are made in, and belong to, `tables`.
  { law.draw(tables) } -> std::same_as<DirectionDraw>;
};

/// W of channels that were solved before, by their length over their radius.
using Transmissions = std::map<double, double>;
/// What it asks of one that a source can be aimed with: what such a source emits, and does not draw, counts.
template <class L>
concept AimableDistribution = requires(const L& law, LawTables& tables, DirectionDraw& draw,
                                       Transmissions& known) {
  // [1/sr] Share of all that leaves into the forward hemisphere, per solid angle on the axis.
  { law.density_on_axis(known) } -> std::same_as<double>;
  // Adds what kernels weigh directions with.
  law.weigh(tables, draw);
};

struct ParallelDirection {
  static constexpr std::string_view kind = "parallel", meaning = "every particle starts along +y";
  bool operator==(const ParallelDirection&) const = default;

  double widest_angle(double deviations) const;
  DirectionDraw draw(LawTables&) const;
};
static_assert(DirectionDistribution<ParallelDirection>);

/// Slopes dx/dy and dz/dy are independent normal variables.
struct GaussianDirection {
  static constexpr std::string_view kind = "gaussian",
                                    meaning = "slopes dx/dy and dz/dy, each normally distributed";
  double x = 0;  // [rad] standard deviation of the slope dx/dy
  double z = 0;  // [rad] of dz/dy
  bool operator==(const GaussianDirection&) const = default;

  double widest_angle(double deviations) const;
  DirectionDraw draw(LawTables&) const;
};
static_assert(DirectionDistribution<GaussianDirection>);
template <>
inline constexpr auto parameters<GaussianDirection> = std::tuple{
    param("x", &GaussianDirection::x, Dimension::angle, range::below_right_angle,
          "standard deviation of the slope dx/dy; the angle in radians is the slope: 2 mrad is 0.002, and 10 "
          "deg is 0.1745, not tan 10 deg"),
    param("z", &GaussianDirection::z, Dimension::angle, range::below_right_angle,
          "standard deviation of the slope dz/dy; the angle in radians is the slope: 2 mrad is 0.002, and 10 "
          "deg is 0.1745, not tan 10 deg"),
};

/// Uniform in solid angle inside a cone around +y.
struct ConeDirection {
  static constexpr std::string_view kind = "cone",
                                    meaning = "uniform in solid angle inside a cone around the beam";
  double half_angle = 0;  // [rad]
  bool operator==(const ConeDirection&) const = default;

  double widest_angle(double deviations) const;
  DirectionDraw draw(LawTables&) const;
};
static_assert(DirectionDistribution<ConeDirection>);
template <>
inline constexpr auto parameters<ConeDirection> = std::tuple{
    param("half_angle", &ConeDirection::half_angle, Dimension::angle, range::below_right_angle,
          "angle between the axis and the rim of the cone"),
};

/// Slopes dx/dy and dz/dy are independent and uniform.
struct BoxDirection {
  static constexpr std::string_view kind = "box",
                                    meaning = "slopes dx/dy and dz/dy, each spread evenly about 0";
  double x = 0;  // [rad] the largest |dx/dy|
  double z = 0;  // [rad] the largest |dz/dy|
  bool operator==(const BoxDirection&) const = default;

  double widest_angle(double deviations) const;
  DirectionDraw draw(LawTables&) const;
};
static_assert(DirectionDistribution<BoxDirection>);
template <>
inline constexpr auto parameters<BoxDirection> = std::tuple{
    param("x", &BoxDirection::x, Dimension::angle, range::below_right_angle,
          "largest slope dx/dy to either side; the angle in radians is the slope: 2 mrad is 0.002, and 10 "
          "deg is 0.1745, not tan 10 deg"),
    param("z", &BoxDirection::z, Dimension::angle, range::below_right_angle,
          "largest slope dz/dy to either side; the angle in radians is the slope: 2 mrad is 0.002, and 10 "
          "deg is 0.1745, not tan 10 deg"),
};

/// Lambert's law, what leaves a thin hole: flux per solid angle ~ cos(theta).
struct CosineDirection {
  static constexpr std::string_view kind = "cosine",
                                    meaning = "what leaves a thin hole of an oven: Lambert's law, cos(theta)";
  double half_angle = 1.5707963267948966;  // [rad] nothing starts beyond
  bool operator==(const CosineDirection&) const = default;

  double widest_angle(double deviations) const;
  DirectionDraw draw(LawTables&) const;
};
static_assert(DirectionDistribution<CosineDirection>);
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

  double widest_angle(double deviations) const;
  DirectionDraw draw(LawTables&) const;
  double density_on_axis(Transmissions& known) const;
  void weigh(LawTables&, DirectionDraw&) const;
};
static_assert(DirectionDistribution<ChannelDirection>);
static_assert(AimableDistribution<ChannelDirection>);
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

  double density_on_axis(Transmissions& known) const;
  void weigh(LawTables&, DirectionDraw&) const;
};
static_assert(AimableDistribution<IsotropicEmission>);
struct CosineEmission {
  static constexpr std::string_view kind = "cosine", meaning = CosineDirection::meaning;
  bool operator==(const CosineEmission&) const = default;

  double density_on_axis(Transmissions& known) const;
  void weigh(LawTables&, DirectionDraw&) const;
};
static_assert(AimableDistribution<CosineEmission>);
using EmissionLaw = std::variant<IsotropicEmission, CosineEmission, ChannelDirection>;

/// Of all that such a source emits only the particles towards one opening are drawn, uniform over it. Each
/// carries the weight g(theta) cos^3(theta), since dOmega = cos^3(theta) dA/D^2, with the law's density per
/// solid angle relative to the axis g = 1 (isotropic), cos(theta) (cosine), j(theta) cos(theta) (channel). In
/// free fall the opening is aimed at along the lower of both parabolas, which spreads the weight differently.
/// What weight 1 stands for stays a factor of the result.
struct AimedDirection {
  static constexpr std::string_view kind = "aimed",
                                    meaning = "only what starts towards one opening downstream";
  std::string target;  // name of a slit or detector
  EmissionLaw emission = IsotropicEmission{};
  bool operator==(const AimedDirection&) const = default;

  double widest_angle(double deviations) const;
  DirectionDraw draw(LawTables&) const;
};
static_assert(DirectionDistribution<AimedDirection>);
template <>
inline constexpr auto parameters<AimedDirection> = std::tuple{
    param("target", &AimedDirection::target, "name of the slit or detector that the source is aimed at"),
    param("emission", &AimedDirection::emission,
          "law of directions of the whole source, of which that is a part", IsotropicEmission{}),
};
using DirectionLaw = std::variant<ParallelDirection, GaussianDirection, ConeDirection, AimedDirection,
                                  CosineDirection, BoxDirection, ChannelDirection>;

}  // namespace rabiline
