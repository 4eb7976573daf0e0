#pragma once
// How strong the field of wound wire is: by its current, or by what it makes.
#include <variant>

#include "parameter/parameter.hpp"

namespace rabiline {

struct CoilCurrent {
  static constexpr std::string_view kind = "current", meaning = "the current in each turn";
  double current = 0;  // [A] right-handed about the direction
  double turns = 1;
  bool operator==(const CoilCurrent&) const = default;
};
template <>
inline constexpr auto parameters<CoilCurrent> = std::tuple{
    param("current", &CoilCurrent::current, Dimension::current, range::any,
          "in each turn, right-handed about the direction"),
    param("turns", &CoilCurrent::turns, Dimension::number, range::positive, "how many turns there are", 1.0),
};
struct CoilField {
  static constexpr std::string_view kind = "field", meaning = "the field in the middle";
  double field = 0;  // [T]
  bool operator==(const CoilField&) const = default;
};
template <>
inline constexpr auto parameters<CoilField> = std::tuple{
    param("field", &CoilField::field, Dimension::magnetic_field, range::any,
          "in the middle, along the direction"),
};
using CoilStrength = std::variant<CoilCurrent, CoilField>;
template <>
inline constexpr std::string_view tag_key<CoilStrength> = "";  // told apart by their keys
template <>
inline constexpr std::string_view said_by_keys<CoilStrength> = "its strength";

}  // namespace rabiline
