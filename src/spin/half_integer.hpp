#pragma once

namespace rabiline {

/// A spin quantum number, kept as twice its value so that 3/2 is exact.
struct HalfInteger {
  int twice = 0;
  double value() const { return twice / 2.0; }
  bool operator==(const HalfInteger&) const = default;
};

}  // namespace rabiline
