#pragma once
#include "parts/fringe.hpp"
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// The field of two wires between iron poles whose faces are the surfaces of equal potential of that field:
/// circles through the places of the wires, at (+-a, 0). The convex pole's face meets the symmetry line at
/// `convex`, the concave one's at `concave`, both above the wires' plane; what touches them or leaves the
/// width is stopped. Force and hypothesis as of TwoWireMagnet.
struct IronMagnet {
  static constexpr std::string_view kind = "iron_magnet",
                                    meaning =
                                        "a deflecting magnet: iron poles with the field of two wires; "
                                        "under dorado a uniform field";
  static constexpr PartTraits traits{.field = true, .deflects = true};
  double length = 0;                    // [m]
  double field = 0;                     // [T] along +z, at the beam
  double half_distance = 0;             // [m] a
  double convex = 0, concave = 0;       // [m] above the wires' plane
  double width = 0;                     // [m] along x
  std::optional<double> beam_height{};  // [m]
  Offset offset{};
  Roll tilt{};
  Fringe fringe{};
  bool operator==(const IronMagnet&) const = default;
};
template <>
inline constexpr auto parameters<IronMagnet> = std::tuple{
    param("length", &IronMagnet::length, Dimension::length, range::positive, "extent along the beam"),
    param("field", &IronMagnet::field, Dimension::magnetic_field, range::any,
          "at `beam_height` on the symmetry line, along +z"),
    param(
        "half_distance", &IronMagnet::half_distance, Dimension::length, range::positive,
        "half of the distance between the two wires of the same field, a: the poles' faces go through them"),
    param("convex", &IronMagnet::convex, Dimension::length, range::positive,
          "height of the convex pole's face above the wires' plane: where the field is strong"),
    param("concave", &IronMagnet::concave, Dimension::length, range::positive,
          "height of the concave pole's face"),
    param("width", &IronMagnet::width, Dimension::length, range::positive, "free extent of the gap along x"),
    param("beam_height", &IronMagnet::beam_height, Dimension::length, range::positive,
          "height of the beam above the wires' plane; 1.2 a if omitted"),
    param("offset", &IronMagnet::offset, "displacement of the magnet from where the beam is at that height",
          Offset{}),
    param(
        "tilt", &IronMagnet::tilt,
        "turn of the magnet, field and all, about the beam: by 180 deg the convex pole is above it, and with "
        "the field reversed that is along +z again",
        Roll{}),
    param("fringe", &IronMagnet::fringe,
          "how the field ends at both ends, followed in steps; at once if omitted, in closed form",
          Fringe{HardFringe{}}),
};

void contribute(const IronMagnet&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const IronMagnet&, const Placement&);

}  // namespace rabiline
