#pragma once
// The spin that particles start with, and when they start.
#include <optional>
#include <variant>
#include <vector>

#include "core/unit_vector.hpp"
#include "parameter/parameter.hpp"
#include "particle/draw.hpp"
#include "spin/level_names.hpp"

namespace rabiline {

struct UnpolarisedSpin {
  static constexpr std::string_view kind = "unpolarised", meaning = "no direction of the spin is preferred";
  bool operator==(const UnpolarisedSpin&) const = default;
};

/// The spin S, not the moment, points along the axis with probability (1 + degree)/2, else against it. Of a
/// spin above 1/2 these are the levels m = I and m = -I along the axis.
struct PolarisedSpin {
  static constexpr std::string_view kind = "polarised",
                                    meaning = "the spin S points along an axis or against it";
  UnitVector axis;
  double degree = 1;
  bool operator==(const PolarisedSpin&) const = default;
};
template <>
inline constexpr auto parameters<PolarisedSpin> = std::tuple{
    param("axis", &PolarisedSpin::axis, "where the spin S points to; a negative moment points away"),
    param("degree", &PolarisedSpin::degree, Dimension::number, range::fraction,
          "S points along the axis with probability (1 + degree)/2, else against it"),
};

/// Levels m along an axis. Under the vector laws: S_z = m/I along it, at a random azimuth.
struct PopulatedSpin {
  static constexpr std::string_view kind = "populations", meaning = "shares of the levels m along an axis";
  UnitVector axis;
  std::vector<double> values;  // of m = I, I-1, ... -I
  bool operator==(const PopulatedSpin&) const = default;
};
template <>
inline constexpr auto parameters<PopulatedSpin> = std::tuple{
    param("axis", &PopulatedSpin::axis, "axis along which the levels have their m", UnitVector{}),
    param("values", &PopulatedSpin::values, Dimension::number, range::fraction,
          "shares of m = I, I-1, ... -I, which add up to 1: [0.75, 0.25] for a spin 1/2"),
};

/// Levels of an atom by Boltzmann's law in the field of the source.
struct ThermalSpin {
  static constexpr std::string_view kind = "thermal",
                                    meaning = "levels of an atom by Boltzmann's law at a temperature";
  double temperature = 0;  // [K]
  double field = 0;        // [T] at the source
  bool operator==(const ThermalSpin&) const = default;
};
template <>
inline constexpr auto parameters<ThermalSpin> = std::tuple{
    param("temperature", &ThermalSpin::temperature, Dimension::temperature, range::positive,
          "temperature of the levels, such as the oven's"),
    param("field", &ThermalSpin::field, Dimension::magnetic_field, range::not_negative,
          "field at the source, which parts the levels", 0.0),
};

/// Named levels of an atom.
struct LevelsSpin {
  static constexpr std::string_view kind = "levels", meaning = "named levels of an atom";
  std::vector<LevelName> levels;
  std::optional<std::vector<double>> shares{};
  bool operator==(const LevelsSpin&) const = default;
};
template <>
inline constexpr auto parameters<LevelsSpin> = std::tuple{
    param("levels", &LevelsSpin::levels, "their names, such as [F=4 m=0, F=3 m=0]"),
    param("shares", &LevelsSpin::shares, Dimension::number, range::fraction,
          "share of the particles in each, which add up to 1; equal shares if omitted"),
};
using StartSpin = std::variant<UnpolarisedSpin, PolarisedSpin, PopulatedSpin, ThermalSpin, LevelsSpin>;

struct RectanglePulse {
  static constexpr std::string_view kind = "rectangle", meaning = "particles start evenly during the pulse";
  double length = 0;  // [s] from t = 0 on
  bool operator==(const RectanglePulse&) const = default;
};
template <>
inline constexpr auto parameters<RectanglePulse> = std::tuple{
    param("length", &RectanglePulse::length, Dimension::time, range::positive, "duration, from t = 0 on"),
};
struct GaussianPulse {
  static constexpr std::string_view kind = "gaussian", meaning = "a normal law of starting times about t = 0";
  double sigma = 0;  // [s]
  bool operator==(const GaussianPulse&) const = default;
};
template <>
inline constexpr auto parameters<GaussianPulse> = std::tuple{
    param("sigma", &GaussianPulse::sigma, Dimension::time, range::positive, "standard deviation"),
};
/// When particles start. Without a pulse every clock begins as its particle starts.
using Pulse = std::variant<RectanglePulse, GaussianPulse>;
template <>
inline constexpr std::string_view tag_key<Pulse> = "shape";

inline PulseDraw draw_of(const std::optional<Pulse>& pulse) {
  if (!pulse) return {};
  if (const auto* gaussian = std::get_if<GaussianPulse>(&*pulse))
    return {PulseKind::gaussian, gaussian->sigma};
  return {PulseKind::rectangle, std::get<RectanglePulse>(*pulse).length};
}
/// When the last particles start [s]; eight standard deviations of a gaussian are never drawn.
inline double latest_start(const std::optional<Pulse>& pulse) {
  if (!pulse) return 0;
  if (const auto* gaussian = std::get_if<GaussianPulse>(&*pulse)) return 8 * gaussian->sigma;
  return std::get<RectanglePulse>(*pulse).length;
}

}  // namespace rabiline
