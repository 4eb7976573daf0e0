#pragma once
// What every part has, whatever its kind: a name and a place on the beam.
#include <optional>
#include <string>
#include <tuple>

#include "core/vector3.hpp"
#include "particle/opening.hpp"

namespace rabiline {

struct Placement {
  std::string name;                  // [A-Za-z][A-Za-z0-9_]*
  double at = 0;                     // [m] where the part begins, from the source's opening
  std::optional<std::string> label;  // how plots call it
  bool operator==(const Placement&) const = default;
};
template <>
inline constexpr auto parameters<Placement> = std::tuple{
    param("name", &Placement::name, "how --set, --scan and results call the part"),
    param("at", &Placement::at, Dimension::length, range::not_negative,
          "where the part begins, from the source"),
    param("label", &Placement::label, "how plots call the part; the name where it is missing"),
};

/// A round wall along a field: what touches it stops there.
struct Bore {
  double radius = 0;  // [m]
  bool operator==(const Bore&) const = default;
};
template <>
inline constexpr auto parameters<Bore> = std::tuple{
    param("radius", &Bore::radius, Dimension::length, range::positive,
          "radius of the free bore around the axis"),
};

inline Vector3 turned(const Vector3& v, const Tilt& tilt) { return turned(v, tilt.x, tilt.y, tilt.z); }

}  // namespace rabiline
