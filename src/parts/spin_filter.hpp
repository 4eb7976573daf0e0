#pragma once
#include "parts/placement.hpp"
#include "spin/level_names.hpp"

namespace rabiline {

class SectionBuilder;

/// A plane that passes spins along its axis with probability `up` and spins against it with `down`: a
/// polariser or an analyser. The transmission is the expectation for each particle, whose weight it
/// multiplies; partial transmission keeps sqrt(up down) of the coherence. Spin 1/2 under `quantum`. Atoms are
/// found in one of the levels of the static field there, as in Lamb-shift polarimeters (J. McKibben, G.
/// Lawrence, G. Ohlsen, Phys. Rev. Lett. 20, 1180 (1968)).
struct SpinFilter {
  static constexpr std::string_view
      kind = "spin_filter",
      meaning =
          "passes spins along an axis better than spins against it, a share of each particle's weight: a "
          "polariser or an analyser";
  static constexpr PartTraits traits{.one_way = true, .sets_spins = true};
  static constexpr std::string_view example = "axis: z, up: 1, down: 0";
  std::optional<UnitVector> axis{};
  double up = 1, down = 0;  // transmissions of the spin S along and against the axis, or of levels
  Tilt tilt{};
  std::vector<LevelName> levels{};
  bool operator==(const SpinFilter&) const = default;
};
template <>
inline constexpr auto parameters<SpinFilter> = std::tuple{
    param("axis", &SpinFilter::axis,
          "axis of the spin S (not of the moment) that is asked for; under `quantum` of spin 1/2; not of "
          "atoms with levels"),
    param("levels", &SpinFilter::levels,
          "of an atom: the levels that pass as `up` says, such as [F=1 m=+1, F=1 m=0]; the others pass as "
          "`down` "
          "says",
          std::vector<LevelName>{}),
    param("up", &SpinFilter::up, Dimension::number, range::fraction,
          "transmission of spins along the axis, or of the levels"),
    param("down", &SpinFilter::down, Dimension::number, range::fraction,
          "transmission of spins against it, or of the other levels"),
    param("tilt", &SpinFilter::tilt, "how the axis is turned", Tilt{}),
};

void contribute(const SpinFilter&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const SpinFilter&, const Placement&);

}  // namespace rabiline
