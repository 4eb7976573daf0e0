#pragma once
// How the size of an alternating field runs along its length.
#include <array>
#include <cstdint>
#include <variant>

#include "field/terms.hpp"
#include "parameter/parameter.hpp"

namespace rabiline {

struct RectangularProfile {
  static constexpr std::string_view kind = "rectangular", meaning = "the same everywhere, with hard edges";
  bool operator==(const RectangularProfile&) const = default;
};
struct HalfSineProfile {
  static constexpr std::string_view kind = "half_sine",
                                    meaning = "half a sine: zero at both ends, full in the middle";
  bool operator==(const HalfSineProfile&) const = default;
};
struct GaussianProfile {
  static constexpr std::string_view kind = "gaussian",
                                    meaning = "a normal curve about the middle, cut at the ends";
  double sigma = 0;  // [m]
  bool operator==(const GaussianProfile&) const = default;
};
template <>
inline constexpr auto parameters<GaussianProfile> = std::tuple{
    param("sigma", &GaussianProfile::sigma, Dimension::length, range::positive,
          "standard deviation along the beam"),
};
/// What a standing wave has at its ends.
enum class WaveEnds { nodes, antinodes };
template <>
inline constexpr auto choices<WaveEnds> = std::array{
    Choice<WaveEnds>{"nodes", WaveEnds::nodes, "sin(n pi y/L): none at both ends, as in a cavity TE10n"},
    Choice<WaveEnds>{"antinodes", WaveEnds::antinodes,
                     "cos(n pi y/L): full at both ends, as on a strip line"},
};
inline constexpr Range half_waves_range{1, 64, true, true, "from 1 to 64"};
/// The field of a cavity: from half wave to half wave it has opposite signs.
struct StandingWaveProfile {
  static constexpr std::string_view kind = "standing_wave",
                                    meaning = "half waves with nodes or antinodes at both ends";
  std::uint64_t half_waves = 1;
  WaveEnds ends = WaveEnds::nodes;
  bool operator==(const StandingWaveProfile&) const = default;
};
template <>
inline constexpr auto parameters<StandingWaveProfile> = std::tuple{
    param("half_waves", &StandingWaveProfile::half_waves, Dimension::number, half_waves_range,
          "how many over its length", 1.0),
    param("ends", &StandingWaveProfile::ends, "what it has at its ends", WaveEnds::nodes),
};

/// Of a static field's size.
using AmplitudeProfile = std::variant<RectangularProfile, HalfSineProfile, GaussianProfile>;
/// Of an alternating one's amplitude.
using DriveProfile = std::variant<RectangularProfile, HalfSineProfile, GaussianProfile, StandingWaveProfile>;

inline Envelope envelope_of(const DriveProfile& shape, double begin, double length) {
  if (const auto* gaussian = std::get_if<GaussianProfile>(&shape))
    return {Shape::gaussian, begin, length, gaussian->sigma};
  if (const auto* wave = std::get_if<StandingWaveProfile>(&shape))
    return {Shape::standing_wave,
            begin,
            length,
            0,
            static_cast<double>(wave->half_waves),
            wave->ends == WaveEnds::antinodes};
  return {std::holds_alternative<HalfSineProfile>(shape) ? Shape::half_sine : Shape::rectangular, begin,
          length, 0};
}

}  // namespace rabiline
