#pragma once
// The tables: each parameter of a beamline file is stated once, with key, unit, range, meaning and default.
// One table drives reading, checking, `rabiline describe`, --set, --scan and the echo in the output.
#include <cstdint>
#include <optional>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "core/units.hpp"

namespace rabiline {

namespace range {
inline constexpr double infinite = 1e300;  // what lies beyond is refused
}
/// Which values a number may take, in SI; `words` completes "must be ...".
struct Range {
  double low;
  double high;
  bool low_included;
  bool high_included;
  std::string_view words;
  constexpr bool contains(double x) const {
    return (low_included ? x >= low : x > low) && (high_included ? x <= high : x < high);
  }
  /// What such a number must be, for one that it does not contain.
  constexpr std::string_view wanted_of(double x) const {
    if (high == range::infinite && x > high) return "at most 1e300 in SI units";
    if (low == -range::infinite && x < low) return "at least -1e300 in SI units";
    return words;
  }
};
namespace range {
inline constexpr Range any{-infinite, infinite, true, true, "finite"};
inline constexpr Range positive{0, infinite, false, true, "greater than zero"};
inline constexpr Range not_negative{0, infinite, true, true, "zero or greater"};
inline constexpr Range fraction{0, 1, true, true, "between 0 and 1"};
inline constexpr Range below_right_angle{0, 1.5707963267948966, true, false,
                                         "at least 0 and less than 90 deg"};
inline constexpr Range at_least_one{1, infinite, true, true, "1 or greater"};
}  // namespace range

/// A parameter without a default must be given.
struct Required {};

/// One row of a table: the key in the file, the member it fills, dimension and range (numbers only), the
/// meaning as one line of help, and the default in SI, or Required.
template <class Struct, class Member, class Default = Required>
struct Param {
  std::string_view key;
  Member Struct::*member;
  Dimension dimension;
  Range range;
  std::string_view meaning;
  Default fallback{};
};

/// Rows for quantities and counts.
template <class S, class M>
constexpr Param<S, M> param(std::string_view key, M S::*member, Dimension d, Range r,
                            std::string_view meaning) {
  return {key, member, d, r, meaning, {}};
}
template <class S, class M, class D>
constexpr Param<S, M, D> param(std::string_view key, M S::*member, Dimension d, Range r,
                               std::string_view meaning, D fallback) {
  return {key, member, d, r, meaning, fallback};
}
/// Rows for everything that is no number: names, choices, nested structs, std::optional of these. With an
/// empty key the member's own keys stand in the same mapping, not in one of their own.
template <class S, class M>
constexpr Param<S, M> param(std::string_view key, M S::*member, std::string_view meaning) {
  return {key, member, Dimension::number, range::any, meaning, {}};
}
template <class S, class M, class D>
constexpr Param<S, M, D> param(std::string_view key, M S::*member, std::string_view meaning, D fallback) {
  return {key, member, Dimension::number, range::any, meaning, fallback};
}

/// The table of a struct: a std::tuple of Param. Specialised beside each struct.
template <class Struct>
inline constexpr std::tuple<> parameters{};

/// The key that a value alone, which is no mapping, gives; "" for none. Specialised beside a struct.
template <class Struct>
inline constexpr std::string_view short_key{};

/// A word for each value of an enum, with its meaning.
template <class Enum>
struct Choice {
  std::string_view word;
  Enum value;
  std::string_view meaning;
};
/// The words of an enum: a std::array of Choice<Enum>. Specialised beside each enum.
template <class Enum>
inline constexpr std::tuple<> choices{};

/// How a std::variant is told apart in the file: by the value of a key ("kind", "name"), or, where the key is
/// empty, by the keys that are present. Each alternative has `static constexpr std::string_view kind,
/// meaning`.
template <class Variant>
inline constexpr std::string_view tag_key = "kind";
/// What the keys of a variant with an empty tag say, for "the slit `A` needs its size".
template <class Variant>
inline constexpr std::string_view said_by_keys = "its size";

}  // namespace rabiline
