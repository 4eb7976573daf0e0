#pragma once
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// A shutter in a plane that opens periodically: at time t since emission, or since the pulse began, it is
/// open while the fractional part of frequency t + phase/(2 pi) is less than `open`.
struct Chopper {
  static constexpr std::string_view kind = "chopper", meaning = "a shutter that opens periodically";
  static constexpr PartTraits traits{.one_way = true};
  double open = 1;       // fraction of each period, from its beginning
  double frequency = 0;  // [Hz]
  double phase = 0;      // [rad] by which it runs ahead
  bool operator==(const Chopper&) const = default;
};
template <>
inline constexpr auto parameters<Chopper> = std::tuple{
    param("open", &Chopper::open, Dimension::number, range::fraction,
          "fraction of each period, from its beginning, in which it is open"),
    param("frequency", &Chopper::frequency, Dimension::frequency, range::positive, "how often it opens"),
    param("phase", &Chopper::phase, Dimension::angle, range::any,
          "by which it runs ahead of a period that begins with the time of flight", 0.0),
};

void contribute(const Chopper&, const Placement&, SectionBuilder&);

}  // namespace rabiline
