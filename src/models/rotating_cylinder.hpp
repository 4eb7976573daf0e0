#pragma once
// The rotating cylinder: the system of M. Dorado, "Equations of Motion of Systems with Internal Angular
// Momentum - II", Fig. 1 and eqs. 1-32; equation numbers below are the paper's.
//
// Frames. At first the centre of mass is at the origin and flies along +y, the axis e3 points along +z, and
// X'Y'Z' = (e1, e2, e3) is (x, y, z). X'Y'Z' goes with the axis and not with the spinning (the paper's
// definition b), which leaves its Omega_3 free in (6). We take Omega_3 = 0: the frame turns by what turns the
// axis and by nothing else, as in the law dorado with closure torque. At first the torque is along +y in
// every case, so that the axis turns in the plane of y and z, about -x.
//
// Signs. (6) gives -L Omega_1 = M_2, where (8)-(10) and (57) write +L Omega_1 = M_2. We follow (6), which is
// dL/dt = M.
#include <array>
#include <cstdint>
#include <numbers>
#include <variant>
#include <vector>

#include "models/motion.hpp"
#include "models/times.hpp"
#include "parameter/parameter.hpp"

namespace rabiline {

struct BodyFixedTorque {
  static constexpr std::string_view kind = "body_fixed",
                                    meaning =
                                        "constant along e2 of the frame that goes with the axis: always "
                                        "perpendicular to the axis, as the paper wants it";
  double size = 0;  // [N m]
  bool operator==(const BodyFixedTorque&) const = default;
};
template <>
inline constexpr auto parameters<BodyFixedTorque> = std::tuple{
    param("size", &BodyFixedTorque::size, Dimension::torque, range::not_negative, "size of the torque"),
};

struct SpaceFixedTorque {
  static constexpr std::string_view kind = "space_fixed",
                                    meaning =
                                        "constant along y of the laboratory: perpendicular to the axis at "
                                        "first only, so that the angular momentum grows";
  double size = 0;  // [N m]
  bool operator==(const SpaceFixedTorque&) const = default;
};
template <>
inline constexpr auto parameters<SpaceFixedTorque> = std::tuple{
    param("size", &SpaceFixedTorque::size, Dimension::torque, range::not_negative, "size of the torque"),
};

/// The heavy top has this torque; so has a moment -M along the axis in a field along u.
struct FieldTorque {
  static constexpr std::string_view kind = "field",
                                    meaning =
                                        "size times u x e3 with u fixed in the laboratory: a moment in a "
                                        "field, or the heavy top";
  double size = 0;   // [N m] where the axis is perpendicular to u
  double angle = 0;  // [rad] between the axis and u at first
  bool operator==(const FieldTorque&) const = default;
};
template <>
inline constexpr auto parameters<FieldTorque> = std::tuple{
    param("size", &FieldTorque::size, Dimension::torque, range::not_negative,
          "size of the torque where the axis is perpendicular to u"),
    param("angle", &FieldTorque::angle, Dimension::angle,
          Range{0, std::numbers::pi, false, false, "greater than 0 and less than 180 deg"},
          "angle between the axis and u at first", std::numbers::pi / 2),
};
using CylinderTorque = std::variant<BodyFixedTorque, SpaceFixedTorque, FieldTorque>;

enum class AxisStart { at_rest, precessing };
template <>
inline constexpr auto choices<AxisStart> = std::array{
    Choice<AxisStart>{"at_rest", AxisStart::at_rest, "the torque finds the axis at rest: it nutates"},
    Choice<AxisStart>{"precessing", AxisStart::precessing,
                      "the axis turns at the rate of its precession from the start: no nutation, where the "
                      "torque stays perpendicular"},
};

struct RotatingCylinder {
  static constexpr std::string_view kind = "rotating_cylinder",
                                    meaning =
                                        "a cylinder that spins about its long axis, flies, and feels a "
                                        "torque: the first system of the paper";
  /// For help: values that go together.
  static constexpr std::string_view example =
      "mass: 1 kg, radius: 5 cm, length: 20 cm, spin: 100 Hz, speed: 2 m/s, torque: {kind: body_fixed, size: "
      "0.5 N m}, axis_start: at_rest, duration: 10 s, samples: 2001";
  double mass = 0;    // [kg]
  double radius = 0;  // [m]
  double length = 0;  // [m]
  double spin = 0;    // [Hz] turns per second
  double speed = 0;   // [m/s]
  CylinderTorque torque{};
  AxisStart axis_start = AxisStart::at_rest;
  double duration = 0;        // [s]
  std::uint64_t samples = 0;  // times that are written, both ends included
  bool operator==(const RotatingCylinder&) const = default;
};
template <>
inline constexpr auto parameters<RotatingCylinder> = std::tuple{
    param("mass", &RotatingCylinder::mass, Dimension::mass, range::positive, "mass, spread evenly"),
    param("radius", &RotatingCylinder::radius, Dimension::length, range::positive, "radius of the cylinder"),
    param("length", &RotatingCylinder::length, Dimension::length, range::positive, "length of the cylinder"),
    param("spin", &RotatingCylinder::spin, Dimension::frequency, range::positive,
          "turns per second about the long axis, right-handed about +z; without any there is no M/L"),
    param("speed", &RotatingCylinder::speed, Dimension::speed, range::not_negative,
          "speed of the centre of mass at first, along +y"),
    param("torque", &RotatingCylinder::torque, "the torque, along +y at first"),
    param("axis_start", &RotatingCylinder::axis_start, "how the axis moves at first"),
    param("duration", &RotatingCylinder::duration, Dimension::time, range::positive, "how long it flies"),
    param("samples", &RotatingCylinder::samples, Dimension::number, range_of_samples,
          "times that are written, both ends included"),
};

/// Motions `paper`, `euler` and `standard`.
ModelResult solve(const RotatingCylinder&);
std::vector<Fact> facts_of(const RotatingCylinder&);
std::vector<Fault> faults_of(const RotatingCylinder&);

}  // namespace rabiline
