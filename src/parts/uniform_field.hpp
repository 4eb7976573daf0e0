#pragma once
#include "parts/field_gradient.hpp"
#include "parts/fringe.hpp"
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// A homogeneous field: a static field B, a guide field, a coil of known field. Its edges are hard but where
/// it has a fringe; with a gradient it grows from its middle, on its offset axis, to the sides.
struct UniformField {
  static constexpr std::string_view kind = "uniform_field",
                                    meaning = "a homogeneous static field: B, or a guide field";
  static constexpr PartTraits traits{.field = true, .homogeneous = true};
  double length = 0;  // [m]
  double field = 0;   // [T] along the direction
  std::optional<Bore> bore;
  UnitVector direction{};
  Offset offset{};
  Tilt tilt{};
  FieldGradient gradient{};
  Fringe fringe{};
  AmplitudeProfile profile{};
  bool operator==(const UniformField&) const = default;
};
template <>
inline constexpr auto parameters<UniformField> = std::tuple{
    param("length", &UniformField::length, Dimension::length, range::positive, "extent along the beam"),
    param("field", &UniformField::field, Dimension::magnetic_field, range::any, "field along its direction"),
    param("bore", &UniformField::bore, "wall around the field; none if omitted"),
    param("direction", &UniformField::direction, "direction of the field; z if omitted", UnitVector{}),
    param("offset", &UniformField::offset, "displacement of the bore's centre from the axis", Offset{}),
    param("tilt", &UniformField::tilt, "how the field is turned inside its slab", Tilt{}),
    param("gradient", &UniformField::gradient,
          "how the field grows from place to place; not at all if omitted", FieldGradient{}),
    param("fringe", &UniformField::fringe, "how the field ends at both ends; at once if omitted",
          Fringe{HardFringe{}}),
    param("profile", &UniformField::profile, "how the size of the field runs along its length",
          AmplitudeProfile{RectangularProfile{}}),
};

StaticField static_field(const UniformField&);
void contribute(const UniformField&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const UniformField&, const Placement&);

}  // namespace rabiline
