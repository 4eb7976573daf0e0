#pragma once
// Fields of deflecting magnets across the beam, and the walls in them. Plain values, and functions of any
// number type, since kernels read them: they use + - * / in the order written and nothing of std.
namespace rabiline {

/// A static field without a part along the beam; all that its force needs is its size. In the magnet's own
/// frame, [m] and [T]; +z is along the field on the symmetry line x = 0 of two wires.
enum class MagnetKind {
  gradient,  // B = B_0 + G s, s along (along_x, along_z)
  two_wire,  // (mu_0 I/pi) a/(r1 r2), wires at (+-a, 0): here B_0 (a^2 + h^2)/(r1 r2), B_0 at (0, h)
  multipole  // B_0 (r/R)^p of 2(p + 1) poles
};
struct MagnetShape {
  MagnetKind kind = MagnetKind::gradient;
  double field = 0;                 // [T] B_0
  double gradient = 0;              // [T/m] G
  double along_x = 0, along_z = 1;  // unit vector
  double half_distance = 0;         // [m] a
  double height = 0;                // [m] h
  int power = 1;                    // p
  double radius = 1;                // [m] R
  /// Whether grad |B| jumps where B is zero.
  bool jumps() const { return kind == MagnetKind::gradient || (kind == MagnetKind::multipole && power == 1); }
  bool operator==(const MagnetShape&) const = default;
};

/// The size of the field somewhere, its gradient, and how fast they change there.
template <class Number>
struct FieldSize {
  Number size, along_x, along_z;  // [T], [T/m] of |B|
  Number bend;                    // [T/m^2] about the largest second derivative of |B|
  Number sharpness;               // [1/m^2] 1/l^2, l the length over which the gradient changes
};

/// For B = c/(r1 r2): grad |B| = -|B| (r1/r1^2 + r2/r2^2), vectors from the wires to the point (I. Rabi,
/// J. Kellogg, J. Zacharias, Phys. Rev. 46, 157 (1934)). For r^p: p |B| r/r^2; of a quadrupole (p = 1) it
/// jumps on the axis, where 0 is given. `root` is the square root of a Number.
template <class Number, class Root>
[[gnu::always_inline]] inline FieldSize<Number> field_size(const MagnetShape& shape, Number x, Number z,
                                                           Root root) {
  const Number none = x - x;
  if (shape.kind == MagnetKind::gradient) {
    const Number field = (x * shape.along_x + z * shape.along_z) * shape.gradient + shape.field;
    const Number slope = field < none ? none - shape.gradient : none + shape.gradient;
    return {field < none ? -field : field, slope * shape.along_x, slope * shape.along_z, none, none};
  }
  if (shape.kind == MagnetKind::two_wire) {
    const double a = shape.half_distance, b0 = shape.field < 0 ? -shape.field : shape.field;
    const Number right = 1.0 / ((x - a) * (x - a) + z * z), left = 1.0 / ((x + a) * (x + a) + z * z);
    const Number size = root(right * left) * (b0 * (a * a + shape.height * shape.height));
    return {size, -(size * ((x - a) * right + (x + a) * left)), -(size * (z * (right + left))),
            2.0 * size * (right + left), 2.0 * (right + left)};
  }
  const double inverse = 1 / shape.radius, b0 = shape.field < 0 ? -shape.field : shape.field;
  const Number u = x * inverse, v = z * inverse, r2 = u * u + v * v;
  Number lower = none + 1.0;  // (r/R)^(p - 2)
  if (shape.power == 1) lower = r2 > none ? 1.0 / root(r2) : none;
  if (shape.power > 1 && shape.power % 2 == 1) lower = root(r2);
  for (int k = 3; k < shape.power; k += 2) lower = lower * r2;
  const double slope = shape.power * b0 * inverse, order = shape.power > 2 ? shape.power - 1 : 1;
  // r/r is not smooth on the axis, nor is r^2 r/r.
  Number sharpness = none + (shape.power == 2 ? 0 : order * order * inverse * inverse);
  if (shape.power == 1 || shape.power == 3)
    sharpness = inverse * inverse / (r2 + (shape.power == 1 ? 1e-18 : 1e-3));
  return {lower * r2 * b0, lower * u * slope, lower * v * slope, lower * (slope * inverse * order),
          sharpness};
}

/// A circle that particles must stay outside or inside of.
struct MagnetCircle {
  double x = 0, z = 0, radius = 0;  // [m]
  int free = 0;                     // +1: what is outside is free, -1: what is inside; 0: no circle
  bool operator==(const MagnetCircle&) const = default;
};
/// The free space inside a magnet: within a rectangle and within or outside circles.
struct MagnetWalls {
  bool rectangle = false;
  double x = 0, z = 0, half_x = 0, half_z = 0;  // [m] its centre and halves
  MagnetCircle circles[2];
  bool operator==(const MagnetWalls&) const = default;
};

/// `Mask` is what comparing two Numbers gives.
template <class Mask, class Number>
[[gnu::always_inline]] inline Mask is_free(const MagnetWalls& walls, Number x, Number z) {
  const Number none = x - x;
  Mask free = none == none;
  if (walls.rectangle)
    free = free & (x - walls.x <= none + walls.half_x) & (walls.x - x <= none + walls.half_x) &
           (z - walls.z <= none + walls.half_z) & (walls.z - z <= none + walls.half_z);
  for (const MagnetCircle& circle : walls.circles) {
    if (circle.free == 0) continue;
    const Number dx = x - circle.x, dz = z - circle.z;
    const Number beyond = dx * dx + dz * dz - circle.radius * circle.radius;
    free = free & (circle.free > 0 ? beyond >= none : beyond <= none);
  }
  return free;
}

}  // namespace rabiline
