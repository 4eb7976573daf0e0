#pragma once
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// A plane that passes spins along its axis with probability `up` and spins against it with `down`: a
/// polariser or an analyser. The transmission is the expectation for each particle, whose weight it
/// multiplies; partial transmission keeps sqrt(up down) of the coherence. Spin 1/2 under `quantum`.
struct SpinFilter {
  static constexpr std::string_view
      kind = "spin_filter",
      meaning = "passes spins along an axis better than spins against it: a polariser or an analyser";
  static constexpr PartTraits traits{.one_way = true,
                                     .needs_one_moment = "filters spins 1/2",
                                     .instead = "a deflecting magnet and a slit select levels"};
  static constexpr std::string_view example = "axis: z, up: 1, down: 0";
  UnitVector axis{};
  double up = 1, down = 0;  // transmissions of the spin S along and against the axis
  Tilt tilt{};
  bool operator==(const SpinFilter&) const = default;
};
template <>
inline constexpr auto parameters<SpinFilter> = std::tuple{
    param("axis", &SpinFilter::axis, "axis of the spin S (not of the moment) that is asked for"),
    param("up", &SpinFilter::up, Dimension::number, range::fraction, "transmission of spins along the axis"),
    param("down", &SpinFilter::down, Dimension::number, range::fraction, "transmission of spins against it"),
    param("tilt", &SpinFilter::tilt, "how the axis is turned", Tilt{}),
};

void contribute(const SpinFilter&, const Placement&, SectionBuilder&);

}  // namespace rabiline
