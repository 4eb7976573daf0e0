#pragma once
// How the size of an alternating field runs along its length.
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
using AmplitudeProfile = std::variant<RectangularProfile, HalfSineProfile, GaussianProfile>;

inline Envelope envelope_of(const AmplitudeProfile& shape, double begin, double length) {
  if (const auto* gaussian = std::get_if<GaussianProfile>(&shape))
    return {Shape::gaussian, begin, length, gaussian->sigma};
  return {std::holds_alternative<HalfSineProfile>(shape) ? Shape::half_sine : Shape::rectangular, begin,
          length, 0};
}

}  // namespace rabiline
