#pragma once
#include "parts/fringe.hpp"
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// A homogeneous electric field: plates across the beam, or grids that it passes. Its edges are hard but
/// where it has a fringe.
struct ElectricField {
  static constexpr std::string_view kind = "electric_field",
                                    meaning = "a homogeneous static electric field, between plates or grids";
  static constexpr PartTraits traits{.field = true, .homogeneous = true};
  double length = 0;  // [m]
  double field = 0;   // [V/m] along the direction
  std::optional<Bore> bore;
  UnitVector direction{};
  Offset offset{};
  Tilt tilt{};
  Fringe fringe{};
  bool is_electric() const { return true; }
  bool operator==(const ElectricField&) const = default;
};
template <>
inline constexpr auto parameters<ElectricField> = std::tuple{
    param("length", &ElectricField::length, Dimension::length, range::positive, "extent along the beam"),
    param("field", &ElectricField::field, Dimension::electric_field, range::any, "field along its direction"),
    param("bore", &ElectricField::bore, "wall around the field; none if omitted"),
    param("direction", &ElectricField::direction, "direction of the field; z if omitted", UnitVector{}),
    param("offset", &ElectricField::offset, "displacement of the field's middle from the axis", Offset{}),
    param("tilt", &ElectricField::tilt, "how the field is turned inside its slab", Tilt{}),
    param("fringe", &ElectricField::fringe, "how the field ends at both ends; at once if omitted",
          Fringe{HardFringe{}}),
};

void contribute(const ElectricField&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const ElectricField&, const Placement&);

}  // namespace rabiline
