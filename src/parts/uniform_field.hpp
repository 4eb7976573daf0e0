#pragma once
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// A homogeneous field along +z with hard edges.
struct UniformField {
  static constexpr std::string_view kind = "uniform_field", meaning = "a homogeneous field B along +z";
  double length = 0;  // [m]
  double field = 0;   // [T] along +z
  std::optional<Bore> bore;
  bool operator==(const UniformField&) const = default;
};
template <>
inline constexpr auto parameters<UniformField> = std::tuple{
    param("length", &UniformField::length, Dimension::length, range::positive, "extent along the beam"),
    param("field", &UniformField::field, Dimension::magnetic_field, range::any, "field along +z"),
    param("bore", &UniformField::bore, "wall around the field; none where it is missing"),
};

void contribute(const UniformField&, const Placement&, SectionBuilder&);

}  // namespace rabiline
