#include "plan/magnets.hpp"

#include "core/constants.hpp"

namespace rabiline {

bool deflects(const Law& law) { return !std::holds_alternative<DoradoLaw>(law); }

Deflection deflection_of(const Plane& plane, const MagnetTerm& magnet, const Species& species, int levels) {
  Deflection d;
  d.begin = plane.y;
  d.end = magnet.end;
  d.acceleration =
      species.gyromagnetic_ratio * constants::hbar * species.spin.value() * magnet.gradient / species.mass;
  d.along_x = magnet.along.x;
  d.along_z = magnet.along.z;
  d.levels = levels;
  d.part = plane.part;
  if (magnet.gap) {
    d.has_gap = true;
    d.x0 = magnet.offset.x;
    d.z0 = magnet.offset.z;
    d.half_x = magnet.gap->width / 2;
    d.half_z = magnet.gap->height / 2;
  }
  return d;
}

}  // namespace rabiline
