#include "plan/magnets.hpp"

#include <algorithm>
#include <cmath>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
#include "plan/geometry.hpp"
#include "section/magnet_field.hpp"

namespace rabiline {

double full_moment(const Species& species) {
  return species.gyromagnetic_ratio * constants::hbar * species.spin.value();
}

namespace {

/// F = mu_z dB_z/ds, mu_z = gamma hbar m: the acceleration is that of m = I.
Deflection deflection_of(const Plane& plane, const MagnetTerm& magnet, const Species& species, int levels,
                         double tolerance) {
  Deflection d;
  d.begin = plane.y;
  d.end = magnet.end;
  d.acceleration = full_moment(species) * magnet.shape.gradient / species.mass;
  d.along_x = magnet.shape.along_x;
  d.along_z = magnet.shape.along_z;
  d.levels = levels;
  d.tolerance = tolerance;
  d.part = plane.part;
  d.has_gap = magnet.walls.rectangle;
  d.x0 = magnet.offset.x + magnet.walls.x;
  d.z0 = magnet.offset.z + magnet.walls.z;
  d.half_x = magnet.walls.half_x;
  d.half_z = magnet.walls.half_z;
  return d;
}

/// F = mu(|B|) grad |B|, of levels from their table, of a vector mu = gamma hbar I S . B/|B|.
Steering steering_of(const Plane& plane, const MagnetTerm& magnet, const Species& species, int levels,
                     double tolerance, SampledTables& tables) {
  Steering s;
  s.begin = plane.y;
  s.end = magnet.end;
  s.shape = magnet.shape;
  s.walls = magnet.walls;
  s.x0 = magnet.offset.x;
  s.z0 = magnet.offset.z;
  if (magnet.tilt.y != 0) {
    s.cosine = portable::cos(magnet.tilt.y);
    s.sine = portable::sin(magnet.tilt.y);
  }
  const UnitVector axis = spin_axis(magnet);
  s.axis_x = axis.x;
  s.axis_z = axis.z;
  s.mass = species.mass;
  s.moment = is_against_axis(magnet) ? -full_moment(species) : full_moment(species);
  s.levels = levels;
  s.tolerance = tolerance;
  s.part = plane.part;
  if (levels > 0 && species.structure) {
    const MomentTable& table = tables.moments(*species.structure);
    s.moment = table.largest();
    s.moments = {table.coefficients().data(), table.cells(), table.scale()};
  }
  return s;
}

/// Whether a magnet leaves so little room between its walls that nothing meets the chamber in it.
bool keeps_off(const MagnetTerm& magnet, double chamber) {
  const MagnetWalls& walls = magnet.walls;
  const double c = portable::cos(magnet.tilt.y), s = portable::sin(magnet.tilt.y);
  const auto lies_within = [&](Aperture free, double x, double z) {
    z -= magnet.shape.height;
    free.x0 = magnet.offset.x + c * x + s * z;
    free.z0 = magnet.offset.z + c * z - s * x;
    free.cosine = c;
    free.sine = s;
    return lies_in(free, aperture_of(0, Disc{chamber}, {}));
  };
  Aperture rectangle;
  rectangle.half_x = walls.half_x;
  rectangle.half_z = walls.half_z;
  if (walls.rectangle && lies_within(rectangle, walls.x, walls.z)) return true;
  return std::ranges::any_of(walls.circles, [&](const MagnetCircle& circle) {
    Aperture disc;
    disc.radius = circle.radius;
    return circle.free < 0 && lies_within(disc, circle.x, circle.z);
  });
}

}  // namespace

void add_deflection(const Plane& plane, const MagnetTerm& magnet, const Species& species, int levels,
                    double tolerance, double chamber, SampledTables& tables, std::vector<Stage>& chain) {
  if (keeps_off(magnet, chamber)) chamber = std::numeric_limits<double>::infinity();
  const auto add = [&](auto stage) {
    stage.chamber = chamber;
    chain.push_back(stage);
    if (stage.marks_walls()) chain.push_back(WallStop{{chamber_number, magnet.end}});
  };
  const bool constant_force = magnet.shape.kind == MagnetKind::gradient && !(levels > 0 && species.structure);
  if (!constant_force) {
    add(steering_of(plane, magnet, species, levels, tolerance, tables));
    return;
  }
  const Deflection d = deflection_of(plane, magnet, species, levels, tolerance);
  if (d.has_gap)
    chain.push_back(
        Passage{aperture_of(plane.y, Rectangle{2 * d.half_x, 2 * d.half_z}, {d.x0, d.z0}), plane.part});
  add(d);
}

}  // namespace rabiline
