#pragma once
#include <variant>

#include "parts/fringe.hpp"
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

struct WireCurrent {
  static constexpr std::string_view kind = "current", meaning = "the current in each wire";
  double current = 0;  // [A] positive: the field at the beam is along +z
  bool operator==(const WireCurrent&) const = default;
};
template <>
inline constexpr auto parameters<WireCurrent> = std::tuple{
    param("current", &WireCurrent::current, Dimension::current, range::any,
          "in each wire, in opposite directions; positive: the field at the beam is along +z"),
};
struct FieldAtBeam {
  static constexpr std::string_view kind = "field", meaning = "the field at the beam";
  double field = 0;  // [T] along +z
  bool operator==(const FieldAtBeam&) const = default;
};
template <>
inline constexpr auto parameters<FieldAtBeam> = std::tuple{
    param("field", &FieldAtBeam::field, Dimension::magnetic_field, range::any,
          "at `beam_height` on the symmetry line, along +z"),
};
using WireStrength = std::variant<WireCurrent, FieldAtBeam>;
template <>
inline constexpr std::string_view tag_key<WireStrength> = "";  // told apart by their keys

/// Two wires along the beam with opposite currents (Rabi, Kellogg and Zacharias 1934):
/// |B| = (mu_0 I/pi) a/(r1 r2), and grad |B|/|B| = -2z/(a^2 + z^2) on the symmetry line: the field is
/// stronger towards the wires, which lie below the beam, on the side of -z. F = mu(|B|) grad |B|: a level, or
/// what S has along the field at the beam, stays what it is, wherever that points. The wires stop what
/// touches them. The hypothesis replaces this force, so there the field is uniform, that on the beam's axis,
/// and the wires stop nothing.
struct TwoWireMagnet {
  static constexpr std::string_view
      kind = "two_wire_magnet",
      meaning = "a deflecting magnet: two wires along the beam; under dorado a uniform field";
  static constexpr PartTraits traits{.field = true, .deflects = true};
  double length = 0;         // [m]
  double half_distance = 0;  // [m] a
  double wire_radius = 0;    // [m]
  WireStrength strength;
  std::optional<double> beam_height{};  // [m]
  Offset offset{};
  Roll tilt{};
  Fringe fringe{};
  bool operator==(const TwoWireMagnet&) const = default;
};
template <>
inline constexpr auto parameters<TwoWireMagnet> = std::tuple{
    param("length", &TwoWireMagnet::length, Dimension::length, range::positive, "extent along the beam"),
    param("half_distance", &TwoWireMagnet::half_distance, Dimension::length, range::positive,
          "half of the distance between the wires' centres, a"),
    param("wire_radius", &TwoWireMagnet::wire_radius, Dimension::length, range::positive,
          "radius of the wires, which stop what touches them"),
    param("", &TwoWireMagnet::strength, "the current, or the field at the beam"),
    param("beam_height", &TwoWireMagnet::beam_height, Dimension::length, range::positive,
          "height of the beam above the wires' plane; 1.2 a if omitted"),
    param("offset", &TwoWireMagnet::offset,
          "displacement of the magnet from where the beam is at that height", Offset{}),
    param(
        "tilt", &TwoWireMagnet::tilt,
        "turn of the magnet, field and all, about the beam: by 180 deg the wires lie above it, and with the "
        "current reversed the field there is along +z again",
        Roll{}),
    param("fringe", &TwoWireMagnet::fringe,
          "how the field ends at both ends, followed in steps; at once if omitted, in closed form",
          Fringe{HardFringe{}}),
};

void contribute(const TwoWireMagnet&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const TwoWireMagnet&, const Placement&);

}  // namespace rabiline
