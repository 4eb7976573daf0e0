#pragma once
#include <cstdint>

#include "parts/fringe.hpp"
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

namespace range {
inline constexpr Range poles{4, 20, true, true, "even and between 4 and 20"};
}

/// Poles around the beam: |B| = B_0 (r/r_0)^(n/2 - 1) of n poles, which focuses levels whose energy grows
/// with the field and drives the others out (quadrupole: H. Friedburg, W. Paul 1951; sextupole: n = 6). Its
/// bore stops what touches it. F = mu(|B|) grad |B| as of TwoWireMagnet. The hypothesis replaces this force,
/// so there the field is that on the beam's axis, zero, and the bore stops nothing. With a fringe it is
/// followed as any field that differs from place to place.
struct MultipoleMagnet {
  static constexpr std::string_view kind = "multipole_magnet",
                                    meaning =
                                        "a focusing magnet: 4, 6 or more poles around the beam; no field "
                                        "under dorado";
  static constexpr PartTraits traits{.field = true, .deflects = true};
  double length = 0;        // [m]
  std::uint64_t poles = 6;  // n
  double pole_field = 0;    // [T] B_0
  double radius = 0;        // [m] r_0
  Offset offset{};
  Fringe fringe{};
  bool operator==(const MultipoleMagnet&) const = default;
};
template <>
inline constexpr auto parameters<MultipoleMagnet> = std::tuple{
    param("length", &MultipoleMagnet::length, Dimension::length, range::positive, "extent along the beam"),
    param("poles", &MultipoleMagnet::poles, Dimension::number, range::poles,
          "number of poles: 4 for a quadrupole, 6 for a sextupole"),
    param("pole_field", &MultipoleMagnet::pole_field, Dimension::magnetic_field, range::not_negative,
          "size of the field at the poles' tips"),
    param("radius", &MultipoleMagnet::radius, Dimension::length, range::positive,
          "of the bore: where the poles' tips are, and the wall"),
    param("offset", &MultipoleMagnet::offset, "displacement of its centre from the axis", Offset{}),
    param("fringe", &MultipoleMagnet::fringe,
          "how the field ends at both ends, followed in steps; at once if omitted, in closed form",
          Fringe{HardFringe{}}),
};

void contribute(const MultipoleMagnet&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const MultipoleMagnet&, const Placement&);

}  // namespace rabiline
