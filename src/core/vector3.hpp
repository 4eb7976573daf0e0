#pragma once
// Vectors in the laboratory as plain values: x across, +y along the beam, +z along the static field.
#include <cmath>

#include "core/portable_math.hpp"
#include "core/unit_vector.hpp"

namespace rabiline {

struct Vector3 {
  double x = 0, y = 0, z = 0;
  constexpr Vector3() = default;
  constexpr Vector3(double x_, double y_, double z_) : x(x_), y(y_), z(z_) {}
  constexpr Vector3(const UnitVector& u) : x(u.x), y(u.y), z(u.z) {}  // NOLINT(google-explicit-constructor)
  bool operator==(const Vector3&) const = default;

  friend constexpr Vector3 operator+(const Vector3& a, const Vector3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend constexpr Vector3 operator-(const Vector3& a, const Vector3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend constexpr Vector3 operator*(double s, const Vector3& a) { return {s * a.x, s * a.y, s * a.z}; }
};

constexpr double dot(const Vector3& a, const Vector3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length_of(const Vector3& a) { return portable::hypot(a.x, a.y, a.z); }

/// Any unit vector across a given one.
inline Vector3 some_normal(const Vector3& a) {
  const Vector3 n = std::abs(a.x) < 0.6 ? cross(a, {1, 0, 0}) : cross(a, {0, 1, 0});
  return (1 / length_of(n)) * n;
}

/// The angle between two vectors, from 0 to pi [rad].
inline double angle_between(const Vector3& a, const Vector3& b) {
  return portable::atan2(length_of(cross(a, b)), dot(a, b));
}
/// Whether two vectors point along one line, but for rounding; so does one of no length.
inline bool is_parallel(const Vector3& a, const Vector3& b) {
  return length_of(cross(a, b)) <= 1e-12 * length_of(a) * length_of(b);
}

/// v turned by an angle about a unit axis, right-handed [rad] (Rodrigues).
inline Vector3 turned_about(const Vector3& axis, double angle, const Vector3& v) {
  const double c = portable::cos(angle), s = portable::sin(angle);
  return c * v + s * cross(axis, v) + ((1 - c) * dot(axis, v)) * axis;
}

/// The vector turned about x, then about y, then about z, right-handed [rad]; to the bit where nothing turns.
inline Vector3 turned(Vector3 v, double about_x, double about_y, double about_z) {
  if (about_x != 0) {
    const double c = portable::cos(about_x), s = portable::sin(about_x);
    v = {v.x, c * v.y - s * v.z, s * v.y + c * v.z};
  }
  if (about_y != 0) {
    const double c = portable::cos(about_y), s = portable::sin(about_y);
    v = {c * v.x + s * v.z, v.y, c * v.z - s * v.x};
  }
  if (about_z != 0) {
    const double c = portable::cos(about_z), s = portable::sin(about_z);
    v = {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
  }
  return v;
}

}  // namespace rabiline
