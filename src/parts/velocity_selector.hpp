#pragma once
#include "particle/speed.hpp"
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// A turning drum of helical slots. What misses the nominal speed drifts towards a slot's wall by an amount
/// that is linear in 1/v, so that the transmission is a triangle in the wavelength: `transmission` at the
/// nominal one, half of it at half the resolution to either side. All of it acts in one plane; losses count
/// as stopped.
struct VelocitySelector {
  static constexpr std::string_view kind = "velocity_selector",
                                    meaning = "passes a triangular band of wavelengths, as helical slots do";
  static constexpr PartTraits traits{.one_way = true};
  SpeedQuantity speed;      // along the beam
  double resolution = 0;    // full width at half maximum of the wavelength, relative
  double transmission = 1;  // of the nominal speed
  bool operator==(const VelocitySelector&) const = default;
};
template <>
inline constexpr auto parameters<VelocitySelector> = std::tuple{
    param("speed", &VelocitySelector::speed, Dimension::speed, range::positive,
          "the nominal speed along the beam, or its wavelength or energy"),
    param("resolution", &VelocitySelector::resolution, Dimension::number,
          Range{0, 1, false, true, "greater than 0 and at most 1"},
          "relative full width at half maximum, of the wavelength"),
    param("transmission", &VelocitySelector::transmission, Dimension::number, range::fraction,
          "of the nominal speed", 1.0),
};

void contribute(const VelocitySelector&, const Placement&, SectionBuilder&);

}  // namespace rabiline
