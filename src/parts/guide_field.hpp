#pragma once
#include "parts/fringe.hpp"
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// A field of constant size whose direction turns evenly from one axis to another one along the beam: spins
/// follow it where it turns slowly against their precession (physics: a field turning at angle v/length in
/// the particle's frame, Rabi 1937).
struct GuideField {
  static constexpr std::string_view
      kind = "guide_field",
      meaning = "a static field whose direction turns along the beam, for spins to follow";
  static constexpr PartTraits traits{.field = true};
  double length = 0;  // [m]
  double field = 0;   // [T]
  UnitVector from{}, to{};
  std::optional<Bore> bore;
  Offset offset{};
  Tilt tilt{};
  Fringe fringe{};
  AmplitudeProfile profile{};
  bool operator==(const GuideField&) const = default;
};
template <>
inline constexpr auto parameters<GuideField> = std::tuple{
    param("length", &GuideField::length, Dimension::length, range::positive, "extent along the beam"),
    param("field", &GuideField::field, Dimension::magnetic_field, range::not_negative, "size of the field"),
    param("from", &GuideField::from, "its direction where it begins"),
    param("to", &GuideField::to, "its direction where it ends, less than half a turn away"),
    param("bore", &GuideField::bore, "wall around the field; none if omitted"),
    param("offset", &GuideField::offset, "displacement of the bore's centre from the axis", Offset{}),
    param("tilt", &GuideField::tilt, "how the field is turned inside its slab", Tilt{}),
    param("fringe", &GuideField::fringe,
          "how the field ends at both ends, where it goes on turning; at once if omitted",
          Fringe{HardFringe{}}),
    param("profile", &GuideField::profile, "how the size of the field runs along its length",
          AmplitudeProfile{RectangularProfile{}}),
};

StaticField static_field(const GuideField&);
void contribute(const GuideField&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const GuideField&, const Placement&);

}  // namespace rabiline
