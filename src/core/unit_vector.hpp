#pragma once
// A direction in the laboratory: +y along the beam, +z along the static field.

namespace rabiline {

/// Of length 1.
struct UnitVector {
  double x = 0, y = 0, z = 1;
  bool operator==(const UnitVector&) const = default;
  UnitVector operator-() const { return {0 - x, 0 - y, 0 - z}; }
};

/// Of the two ends of an axis, the one with z < 0; of one across z, that with x < 0, and along y that with y
/// < 0.
inline bool is_downwards(const UnitVector& v) {
  if (v.z != 0) return v.z < 0;
  return v.x != 0 ? v.x < 0 : v.y < 0;
}
/// The other end of it. Levels are those along this one, so that two axes that are one line are one axis.
inline UnitVector upwards(const UnitVector& v) { return is_downwards(v) ? -v : v; }

}  // namespace rabiline
