#pragma once
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// A homogeneous field with hard edges: a static field B, a guide field, a coil of known field.
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
  bool operator==(const UniformField&) const = default;
};
template <>
inline constexpr auto parameters<UniformField> = std::tuple{
    param("length", &UniformField::length, Dimension::length, range::positive, "extent along the beam"),
    param("field", &UniformField::field, Dimension::magnetic_field, range::any, "field along its direction"),
    param("bore", &UniformField::bore, "wall around the field; none where it is missing"),
    param("direction", &UniformField::direction, "direction of the field; z where it is missing",
          UnitVector{}),
    param("offset", &UniformField::offset, "displacement of the bore's centre from the axis", Offset{}),
    param("tilt", &UniformField::tilt, "how the field is turned inside its slab", Tilt{}),
};

StaticField static_field(const UniformField&);
void contribute(const UniformField&, const Placement&, SectionBuilder&);

}  // namespace rabiline
