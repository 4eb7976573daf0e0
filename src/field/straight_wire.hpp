#pragma once
#include "field/field_here.hpp"

namespace rabiline {

/// A straight wire along the z axis of its frame, evenly filled with current.
struct WireShape {
  double strength;     // [T m] mu_0 I/2 pi, the current along +z
  double radius;       // [m]
  double half_length;  // [m]; 0: endless
  bool operator==(const WireShape&) const = default;
};

/// B_phi = (mu_0 I/2 pi r) F, F = (sin of the angle to the upper end - that to the lower one)/2, 1 of an
/// endless wire; in the wire r^2/radius^2 of that. The field of a piece alone has no divergence, but a curl,
/// which that of the wire's leads removes.
template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_of(const WireShape& wire, Number x, Number y,
                                                         Number z) {
  const Number r2 = x * x + y * y, none = r2 - r2;
  Number ends = none + 1.0, per_u = none, per_z = none;  // F, dF/d(r^2), dF/dz
  if (wire.half_length > 0) {
    const Number upper = z + wire.half_length, lower = z - wire.half_length;
    const Number a = 1.0 / Maths::root(r2 + upper * upper), b = 1.0 / Maths::root(r2 + lower * lower);
    const Number a3 = a * a * a, b3 = b * b * b;
    ends = 0.5 * (upper * a - lower * b);
    per_u = 0.25 * (lower * b3 - upper * a3);
    per_z = 0.5 * r2 * (a3 - b3);
  }
  const double core = wire.radius * wire.radius;
  const auto inside = r2 < none + core;
  const Number per_r2 = 1.0 / Maths::select(inside, none + core, r2);
  const Number turn = wire.strength * ends * per_r2;  // B_phi/r
  // d(B_phi/r)/d(r^2), times 2
  const Number bend = 2.0 * wire.strength * per_r2 * (per_u - Maths::select(inside, none, ends * per_r2));
  const Number along = wire.strength * per_z * per_r2;
  FieldHere<Number> here;
  here.field[0] = none - y * turn;
  here.field[1] = x * turn;
  here.field[2] = none;
  here.slope[0] = none - x * y * bend;
  here.slope[1] = none - turn - y * y * bend;
  here.slope[2] = none - y * along;
  here.slope[3] = turn + x * x * bend;
  here.slope[4] = x * y * bend;
  here.slope[5] = x * along;
  here.slope[6] = here.slope[7] = here.slope[8] = none;
  return here;
}

}  // namespace rabiline
