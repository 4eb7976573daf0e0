#pragma once
// B and its nine derivatives at a place, for any number type.
namespace rabiline {

/// B [T] and dB_i/dx_k at slope[3 i + k] [T/m].
template <class Number>
struct FieldHere {
  Number field[3], slope[9];
};

/// Of a field with an axis of symmetry, z, without currents at the place: it follows from B_z, B_r/r,
/// dB_z/dz and (dB_r/dz)/r, since dB_r/dr = -B_r/r - dB_z/dz and dB_z/dr = dB_r/dz. All are finite on the
/// axis.
template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> about_axis(Number x, Number y, Number along, Number out,
                                                           Number along_slope, Number out_slope) {
  const Number none = x - x, r2 = x * x + y * y;
  const Number per_r2 = 1.0 / Maths::select(r2 > none, r2, none + 1.0);
  const Number bend = (none - 2.0 * out - along_slope) * per_r2;  // r d(B_r/r)/dr / r^2
  FieldHere<Number> here;
  here.field[0] = x * out;
  here.field[1] = y * out;
  here.field[2] = along;
  here.slope[0] = out + x * x * bend;
  here.slope[1] = here.slope[3] = x * y * bend;
  here.slope[4] = none - along_slope - here.slope[0];
  here.slope[2] = here.slope[6] = x * out_slope;
  here.slope[5] = here.slope[7] = y * out_slope;
  here.slope[8] = along_slope;
  return here;
}

}  // namespace rabiline
