#pragma once
// A direction in the laboratory: +y along the beam, +z along the static field.

namespace rabiline {

/// Of length 1.
struct UnitVector {
  double x = 0, y = 0, z = 1;
  bool operator==(const UnitVector&) const = default;
};

}  // namespace rabiline
