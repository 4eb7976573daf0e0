#pragma once
#include "parts/fringe.hpp"
#include "parts/multipole_magnet.hpp"
#include "parts/time_factor.hpp"

namespace rabiline {

/// The field of n poles around the beam as a field among others, its edges hard but where it has a fringe:
/// |B| = B_0 (r/r_0)^(n/2 - 1), along +z above the beam. Unlike a MultipoleMagnet it may overlap other
/// fields, and it stops nothing.
struct MultipoleField {
  static constexpr std::string_view kind = "multipole_field",
                                    meaning =
                                        "the field of 4, 6 or more poles around the beam, which may "
                                        "overlap others";
  static constexpr PartTraits traits{.field = true};
  static constexpr std::string_view example = "length: 0.2 m, poles: 4, field: 10 mT, radius: 1 cm";
  double length = 0;        // [m]
  std::uint64_t poles = 4;  // n
  double field = 0;         // [T] B_0
  double radius = 0;        // [m] r_0
  Offset offset{};
  Tilt tilt{};
  std::optional<TimeFactor> oscillates{};
  Fringe fringe{};
  AmplitudeProfile profile{};
  bool operator==(const MultipoleField&) const = default;
};
template <>
inline constexpr auto parameters<MultipoleField> = std::tuple{
    param("length", &MultipoleField::length, Dimension::length, range::positive, "extent along the beam"),
    param("poles", &MultipoleField::poles, Dimension::number, range::poles,
          "number of poles: 4 for a quadrupole, 6 for a sextupole"),
    param("field", &MultipoleField::field, Dimension::magnetic_field, range::any,
          "its size at `radius`, above the beam along +z"),
    param("radius", &MultipoleField::radius, Dimension::length, range::positive, "where `field` is"),
    param("offset", &MultipoleField::offset, "displacement of its centre from the axis", Offset{}),
    param("tilt", &MultipoleField::tilt, "how the field is turned inside its slab", Tilt{}),
    param("oscillates", &MultipoleField::oscillates,
          "frequency and phase with which the whole field swings; it stands if omitted"),
    param("fringe", &MultipoleField::fringe, "how the field ends at both ends; at once if omitted",
          Fringe{HardFringe{}}),
    param("profile", &MultipoleField::profile, "how the size of the field runs along its length",
          AmplitudeProfile{RectangularProfile{}}),
};

void contribute(const MultipoleField&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const MultipoleField&, const Placement&);

}  // namespace rabiline
