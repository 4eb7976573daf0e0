#pragma once
// A hole that particles start from or pass: a rectangle or a disc in a plane of constant y.
#include <tuple>
#include <variant>

#include "parameter/parameter.hpp"

namespace rabiline {

struct Rectangle {
  static constexpr std::string_view kind = "rectangle", meaning = "width along x, height along z";
  double width = 0;   // [m] along x
  double height = 0;  // [m] along z
  bool operator==(const Rectangle&) const = default;
};
template <>
inline constexpr auto parameters<Rectangle> = std::tuple{
    param("width", &Rectangle::width, Dimension::length, range::not_negative, "full extent along x"),
    param("height", &Rectangle::height, Dimension::length, range::not_negative, "full extent along z"),
};

struct Disc {
  static constexpr std::string_view kind = "disc", meaning = "a round hole";
  double radius = 0;  // [m]
  bool operator==(const Disc&) const = default;
};
template <>
inline constexpr auto parameters<Disc> = std::tuple{
    param("radius", &Disc::radius, Dimension::length, range::not_negative, "radius of the hole"),
};

using Opening = std::variant<Rectangle, Disc>;
template <>
inline constexpr std::string_view tag_key<Opening> = "";  // told apart by their keys

/// A displacement across the beam.
struct Offset {
  double x = 0;  // [m]
  double z = 0;  // [m]
  bool operator==(const Offset&) const = default;
};
template <>
inline constexpr auto parameters<Offset> = std::tuple{
    param("x", &Offset::x, Dimension::length, range::any, "displacement along x", 0.0),
    param("z", &Offset::z, Dimension::length, range::any, "displacement along z", 0.0),
};

}  // namespace rabiline
