// How particles start, as the emitting kernel sees it.
#include <cmath>

#include "plan/geometry.hpp"
#include "plan/plan.hpp"

namespace rabiline {
namespace {

const PlacedPart* find_part(const Beamline& beamline, const std::string& name) {
  for (const PlacedPart& part : beamline.parts)
    if (part.placement.name == name) return &part;
  return nullptr;
}

/// The opening that an aimed source is aimed at: a slit's hole or a detector's face.
Aperture target_of(const Beamline& beamline, const std::string& name) {
  const PlacedPart& target = *find_part(beamline, name);
  if (const auto* slit = std::get_if<Slit>(&target.part))
    return aperture_of(target.placement.at, slit->opening, slit->offset, slit->tilt);
  const auto& detector = std::get<Detector>(target.part);
  return aperture_of(target.placement.at, opening_of(detector.face), detector.offset, detector.tilt);
}

}  // namespace

Emission emission_of(const Beamline& beamline, const Component& component, RandomKey key) {
  Emission e;
  e.key = key;
  e.speed = mean_speed(beamline.source.speed);
  if (const auto* gaussian = std::get_if<GaussianSpeed>(&beamline.source.speed)) {
    e.speed_kind = SpeedKind::gaussian;
    e.speed_sigma = gaussian->sigma;
  }
  e.opening = aperture_of(0, beamline.source.opening, {});
  const DirectionLaw& direction = beamline.source.direction;
  if (const auto* gaussian = std::get_if<GaussianDirection>(&direction)) {
    e.direction = DirectionKind::gaussian;
    e.spread_x = gaussian->x;
    e.spread_z = gaussian->z;
  } else if (const auto* cone = std::get_if<ConeDirection>(&direction)) {
    e.direction = DirectionKind::cone;
    const double half = std::sin(cone->half_angle / 2);
    e.spread_x = 2 * half * half;
  } else if (const auto* aimed = std::get_if<AimedDirection>(&direction)) {
    e.direction = DirectionKind::aimed;
    e.target = target_of(beamline, aimed->target);
  }
  if (std::holds_alternative<QuantumLaw>(beamline.law)) e.levels = component.species.spin.twice + 1;
  return e;
}

}  // namespace rabiline
