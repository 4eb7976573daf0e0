#include "plan/magnets.hpp"

#include <algorithm>
#include <cmath>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
#include "plan/geometry.hpp"

namespace rabiline {
namespace {

/// [J/T] along z of m = I, or of S along z.
double full_moment(const Species& species) {
  return species.gyromagnetic_ratio * constants::hbar * species.spin.value();
}

/// F = mu_z dB_z/ds, mu_z = gamma hbar m: the acceleration is that of m = I.
Deflection deflection_of(const Plane& plane, const MagnetTerm& magnet, const Species& species, int levels) {
  Deflection d;
  d.begin = plane.y;
  d.end = magnet.end;
  d.acceleration = full_moment(species) * magnet.shape.gradient / species.mass;
  d.along_x = magnet.shape.along_x;
  d.along_z = magnet.shape.along_z;
  d.levels = levels;
  d.part = plane.part;
  d.has_gap = magnet.walls.rectangle;
  d.x0 = magnet.walls.x;
  d.z0 = magnet.walls.z;
  d.half_x = magnet.walls.half_x;
  d.half_z = magnet.walls.half_z;
  return d;
}

/// F = mu(|B|) grad |B|, of levels from their table, of a vector mu = gamma hbar I S_z.
Steering steering_of(const Plane& plane, const MagnetTerm& magnet, const Species& species, int levels,
                     SampledTables& tables) {
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
  s.mass = species.mass;
  s.moment = full_moment(species);
  s.levels = levels;
  s.part = plane.part;
  if (levels > 0 && species.structure) {
    const MomentTable& table = tables.moments(*species.structure);
    s.moment = table.largest();
    s.moments = {table.coefficients().data(), table.cells(), table.scale()};
  }
  return s;
}

/// [J/T] along the field, where its size is B.
double moment_of(const Steering& s, int level, double size) {
  if (s.moments.coefficients == nullptr) return s.moment * (1 - 2.0 * level / (s.levels - 1));
  const double place = size / (size + s.moments.scale) * s.moments.cells;
  const int cell = std::min(static_cast<int>(place), s.moments.cells - 1);
  const double* c = s.moments.coefficients + std::ptrdiff_t{4} * (level * s.moments.cells + cell);
  const double t = place - cell;
  return ((c[3] * t + c[2]) * t + c[1]) * t + c[0];
}

}  // namespace

bool deflects(const Law& law) { return !std::holds_alternative<DoradoLaw>(law); }

void add_deflection(const Plane& plane, const MagnetTerm& magnet, const Species& species, int levels,
                    SampledTables& tables, std::vector<Stage>& chain) {
  const bool constant_force = magnet.shape.kind == MagnetKind::gradient && !(levels > 0 && species.structure);
  if (!constant_force) {
    chain.push_back(steering_of(plane, magnet, species, levels, tables));
    return;
  }
  const Deflection d = deflection_of(plane, magnet, species, levels);
  if (d.has_gap)
    chain.push_back(
        Passage{aperture_of(plane.y, Rectangle{2 * d.half_x, 2 * d.half_z}, {d.x0, d.z0}), plane.part});
  chain.push_back(d);
}

SteeringOutlook outlook_of(const Steering& s, double speed) {
  const bool multipole = s.shape.kind == MagnetKind::multipole;
  const auto at = field_size(s.shape, multipole ? s.shape.radius / 2 : 0.0, s.shape.height,
                             [](double q) { return std::sqrt(q); });
  SteeringOutlook out;
  out.field = at.size;
  out.gradient = portable::hypot(at.along_x, at.along_z);
  out.acceleration = std::abs(s.moment) / s.mass * out.gradient;
  const double turn =
      s.moments.coefficients != nullptr ? out.gradient * out.gradient / (at.size + s.moments.scale) : 0.0;
  out.rate = std::sqrt(std::abs(s.moment) / s.mass * (at.bend + turn));
  out.steps =
      std::clamp(out.rate * (s.end - s.begin) / speed / steering::step_angle, 1.0, steering::most_steps);
  return out;
}

std::optional<double> stopped_at(const Steering& s, int level, double speed) {
  constexpr int steps = 4000;
  const double length = s.end - s.begin, h = length / speed / steps;
  double x = s.sine * s.z0 - s.cosine * s.x0, z = s.shape.height - s.sine * s.x0 - s.cosine * s.z0;
  double vx = 0, vz = 0;
  for (int i = 0; i <= steps; ++i) {
    if (!is_free<bool>(s.walls, x, z)) return s.begin + length * i / steps;
    const auto field = field_size(s.shape, x, z, [](double q) { return std::sqrt(q); });
    if (!std::isfinite(field.size)) return std::nullopt;
    const double pull = moment_of(s, level, field.size) / s.mass;
    vx += h * pull * field.along_x;
    vz += h * pull * field.along_z;
    x += h * vx;
    z += h * vz;
  }
  return std::nullopt;
}

}  // namespace rabiline
