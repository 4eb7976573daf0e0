#include "section/magnet_field.hpp"

#include <algorithm>
#include <cmath>

namespace rabiline {
namespace {

/// Of the magnet's frame, turned about the beam, at its own (x, z).
ShapedTerm in_frame(ShapedTerm term, const MagnetTerm& magnet, double begin, double x) {
  const double c = portable::cos(magnet.tilt.y), s = portable::sin(magnet.tilt.y);
  const double height = magnet.shape.height;
  term.x = magnet.offset.x + c * x - s * height;
  term.y = begin;
  term.z = magnet.offset.z - s * x - c * height;
  const double axes[9] = {c, 0, -s, 0, 1, 0, s, 0, c};
  for (int i = 0; i < 9; ++i) term.axes[i] = axes[i];
  term.turned = s != 0 || c != 1;
  return term;
}

/// A wire along the beam: its own z axis is the frame's y, its x the frame's z.
ShapedTerm along_beam(ShapedTerm wire) {
  double axes[9];
  for (int i = 0; i < 3; ++i) {
    axes[i] = wire.axes[6 + i];
    axes[3 + i] = wire.axes[i];
    axes[6 + i] = wire.axes[3 + i];
  }
  for (int i = 0; i < 9; ++i) wire.axes[i] = axes[i];
  wire.turned = true;
  return wire;
}

UnitVector field_at_beam(const MagnetTerm& magnet) {
  if (magnet.shape.kind != MagnetKind::two_wire || magnet.shape.field == 0) return {};
  const double sign = magnet.shape.field < 0 ? -1 : 1;
  const double x = sign * portable::sin(magnet.tilt.y), z = sign * portable::cos(magnet.tilt.y);
  constexpr double rounding = 1e-12;  // of half a turn, written in degrees
  if (std::abs(x) < rounding) return {0, 0, z < 0 ? -1.0 : 1.0};
  return {x, 0, std::abs(z) < rounding ? 0 : z};
}

}  // namespace

std::array<double, 9> slopes_of(const MagnetShape& shape) {
  std::array<double, 9> slopes{};
  slopes[0] = -shape.gradient * shape.along_z;
  slopes[8] = shape.gradient * shape.along_z;
  slopes[2] = slopes[6] = shape.gradient * shape.along_x;
  return slopes;
}

std::vector<ShapedTerm> field_terms_of(const MagnetTerm& magnet, double begin) {
  const MagnetShape& shape = magnet.shape;
  if (shape.kind == MagnetKind::two_wire) {
    // B_z = S ((x + a)/r2^2 - (x - a)/r1^2), S = B_0 (a^2 + h^2)/2a; the wire at -a carries its current
    // against the beam: about +y, B_z falls with x.
    const double a = shape.half_distance, core = 1e-9 * a;
    const double strength = shape.field * (a * a + shape.height * shape.height) / (2 * a);
    return {along_beam(in_frame(ShapedTerm(WireShape{strength, core, 0}), magnet, begin, a)),
            along_beam(in_frame(ShapedTerm(WireShape{-strength, core, 0}), magnet, begin, -a))};
  }
  if (shape.kind == MagnetKind::multipole)
    return {in_frame(ShapedTerm(MultipoleShape{shape.power, shape.field, shape.radius}), magnet, begin, 0)};
  LinearShape linear{};
  linear.field[2] = shape.field;
  std::ranges::copy(slopes_of(shape), linear.slope);
  return {in_frame(ShapedTerm(linear), magnet, begin, 0)};
}

UnitVector spin_axis(const MagnetTerm& magnet) { return upwards(field_at_beam(magnet)); }

bool is_against_axis(const MagnetTerm& magnet) { return is_downwards(field_at_beam(magnet)); }

}  // namespace rabiline
