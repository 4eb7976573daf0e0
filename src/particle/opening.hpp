#pragma once
// A hole that particles start from or pass, in a plane of constant y, and how parts are displaced.
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "core/fault.hpp"
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
    param("radius", &Disc::radius, Dimension::length, range::not_negative, "from its centre to its edge"),
};

/// What is open between two circles.
struct Ring {
  static constexpr std::string_view kind = "ring", meaning = "open between two circles";
  double inner_radius = 0;  // [m]
  double outer_radius = 0;  // [m]
  bool operator==(const Ring&) const = default;
};
template <>
inline constexpr auto parameters<Ring> = std::tuple{
    param("inner_radius", &Ring::inner_radius, Dimension::length, range::not_negative,
          "where the ring begins"),
    param("outer_radius", &Ring::outer_radius, Dimension::length, range::not_negative, "where it ends"),
};

using Opening = std::variant<Rectangle, Disc, Ring>;
template <>
inline constexpr std::string_view tag_key<Opening> = "";  // told apart by their keys

/// What a detector turns to the beam, or the opening of a channel. A convex opening: a straight path that is
/// inside at both ends is inside throughout.
using Face = std::variant<Rectangle, Disc>;
template <>
inline constexpr std::string_view tag_key<Face> = "";
inline Opening opening_of(const Face& face) {
  return std::visit([](const auto& shape) { return Opening(shape); }, face);
}

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

/// A ring that is turned inside out; `key` is that of the opening, empty where its keys stand among others.
std::vector<Fault> faults_of(const Opening&, const std::string& subject, const std::string& key);
/// A face that nothing can pass or hit; `whose`: "`screen`".
std::vector<Fault> faults_of_size(const Face&, const std::string& subject, const std::string& key,
                                  const std::string& whose);
/// How far from the axis the nearest point of a hole or screen is [m].
double distance_from_axis(const Opening&, Offset, double roll);

/// How a plane part is turned: only within its plane, since edges stay planes of constant y.
struct Roll {
  double y = 0;  // [rad] right-handed about the beam: from +z towards +x
  bool operator==(const Roll&) const = default;
};
template <>
inline constexpr auto parameters<Roll> = std::tuple{
    param("y", &Roll::y, Dimension::angle, range::any,
          "turn about the beam, right-handed: from +z towards +x", 0.0),
};

/// How a field is turned inside its slab: about x, then about y, then about z, each right-handed.
struct Tilt {
  double x = 0, y = 0, z = 0;  // [rad]
  bool operator==(const Tilt&) const = default;
};
template <>
inline constexpr auto parameters<Tilt> = std::tuple{
    param("x", &Tilt::x, Dimension::angle, range::any, "first turn, about x: from +y towards +z", 0.0),
    param("y", &Tilt::y, Dimension::angle, range::any, "second turn, about the beam: from +z towards +x",
          0.0),
    param("z", &Tilt::z, Dimension::angle, range::any, "third turn, about z: from +x towards +y", 0.0),
};

}  // namespace rabiline
