#pragma once
#include "parts/placement.hpp"
#include "parts/time_factor.hpp"

namespace rabiline {

class SectionBuilder;

/// A flat sheet of current through the place `at` and its offset: across the beam, where fields on both sides
/// of it point apart and spins cannot follow, as in the flipper of J. W. T. Dabbs, L. D. Roberts and
/// S. Bernstein (ORNL-CF-55-5-126, 1955), or turned along it. Its leads are left out. It stops nothing.
struct CurrentSheet {
  static constexpr std::string_view kind = "current_sheet",
                                    meaning =
                                        "the field of a flat sheet of current, which particles may fly "
                                        "through";
  static constexpr std::string_view place = "the middle of the sheet, from the source";
  static constexpr PartTraits traits{.field = true};
  static constexpr std::string_view example = "current: 100 A, width: 10 cm, reach: 20 cm";
  double current = 0;  // [A]
  double width = 0;    // [m]
  double reach = 0;    // [m]
  Offset offset{};
  Tilt tilt{};
  std::optional<TimeFactor> oscillates{};
  bool operator==(const CurrentSheet&) const = default;
};
template <>
inline constexpr auto parameters<CurrentSheet> = std::tuple{
    param("current", &CurrentSheet::current, Dimension::current, range::any,
          "in all of the sheet; along +x where nothing is turned: B points along -z before the sheet, along "
          "+z behind it"),
    param("width", &CurrentSheet::width, Dimension::length, range::positive,
          "of the sheet, along z where nothing is turned; along the current it is endless"),
    param("reach", &CurrentSheet::reach, Dimension::length, range::positive,
          "how far from `at` the field is taken on both sides; it falls as one over the distance"),
    param("offset", &CurrentSheet::offset, "displacement of the sheet's middle from the axis", Offset{}),
    param("tilt", &CurrentSheet::tilt, "how the sheet is turned; it stands square to the beam", Tilt{}),
    param("oscillates", &CurrentSheet::oscillates,
          "frequency and phase with which the whole field swings; it stands if omitted"),
};

void contribute(const CurrentSheet&, const Placement&, SectionBuilder&);

}  // namespace rabiline
