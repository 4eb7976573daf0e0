#pragma once
#include "parts/fringe.hpp"
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// The field B' that aligns the moments: an idealisation, since a homogeneous field alone does not polarise a
/// beam in flight. Whatever the spin I, a particle that enters gets the stretched state with its moment along
/// B' with probability (1 + alignment)/2, else the one with its moment against B': a mixture, never a cone.
/// Of an atom with levels these are F = I + J with m = F and m = -F. The field is along +z and acts on the
/// flight like any uniform field.
struct Polarizer {
  static constexpr std::string_view kind = "polarizer",
                                    meaning = "aligns the moments with its field B', along +z";
  static constexpr PartTraits traits{.field = true, .sets_spins = true};
  double length = 0;     // [m]
  double field = 0;      // [T] along +z
  double alignment = 1;  // mean moment along B', in units of the full moment
  std::optional<Bore> bore;
  Offset offset{};
  Tilt tilt{};
  Fringe fringe{};
  bool operator==(const Polarizer&) const = default;
};
template <>
inline constexpr auto parameters<Polarizer> = std::tuple{
    param("length", &Polarizer::length, Dimension::length, range::positive, "extent along the beam"),
    param("field", &Polarizer::field, Dimension::magnetic_field, range::any, "field along +z"),
    param("alignment", &Polarizer::alignment, Dimension::number, range::fraction,
          "mean moment along the field over the full moment: (1 + alignment)/2 of the particles get it along "
          "the field, the others against it"),
    param("bore", &Polarizer::bore, "wall around the field; none if omitted"),
    param("offset", &Polarizer::offset, "displacement of the bore's centre from the axis", Offset{}),
    param("tilt", &Polarizer::tilt, "how the field is turned inside its slab", Tilt{}),
    param("fringe", &Polarizer::fringe, "how the field ends at both ends; at once if omitted",
          Fringe{HardFringe{}}),
};

void contribute(const Polarizer&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const Polarizer&, const Placement&);

}  // namespace rabiline
