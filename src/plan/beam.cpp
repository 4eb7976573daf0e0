#include "plan/beam.hpp"

#include <algorithm>
#include <cmath>

#include "core/portable_math.hpp"
#include "plan/geometry.hpp"

namespace rabiline {
namespace {

using Span = BeamSpan::Span;

Span about(double middle, double half) { return {middle - half, middle + half}; }
Span operator*(double factor, const Span& s) {
  return {std::min(factor * s.low, factor * s.high), std::max(factor * s.low, factor * s.high)};
}
Span operator+(const Span& a, const Span& b) { return {a.low + b.low, a.high + b.high}; }
/// What both have in common, and the first where that is nothing.
Span narrowed(const Span& a, const Span& b) {
  const Span common{std::max(a.low, b.low), std::min(a.high, b.high)};
  return common.low <= common.high ? common : a;
}
HalfSizes halves_of(const Aperture& a) {
  return a.radius >= 0 ? HalfSizes{a.radius, a.radius} : HalfSizes{a.half_x, a.half_z};
}

/// dx/dy and dz/dy of the axis of directions, which is turned first about x, then about z.
Offset slope_of(const SourceTilt& tilt) {
  return {-portable::tan(tilt.z), portable::tan(tilt.x) / portable::cos(tilt.z)};
}

}  // namespace

Offset axis_of_beam(const Source& source, double y) {
  const Offset slope = slope_of(source.tilt);
  return {source.offset.x + slope.x * y, source.offset.z + slope.z * y};
}

std::vector<Offset> BeamSpan::sides() const {
  return {{x.high, z.middle()}, {x.low, z.middle()}, {x.middle(), z.high}, {x.middle(), z.low}};
}

BeamSpan beam_at(double y, const Beamline& beamline, const Sections& sections) {
  const Source& source = beamline.source;
  const double angle = std::visit([](const auto& law) { return law.widest_angle(1); }, source.direction);
  const Offset slope = slope_of(source.tilt);
  const HalfSizes half = halves_of(source.opening);
  const Span own_x = about(source.offset.x, half.x), own_z = about(source.offset.z, half.z);
  BeamSpan beam{own_x + y * about(slope.x, angle), own_z + y * about(slope.z, angle)};
  const auto passes = [&](double at, const Aperture& hole) {
    const HalfSizes size = halves_of(hole);
    const auto through = [&](const Span& from, const Span& to, double along) {
      return angle == 0 ? to + about(along * (y - at), 0) : (1 - y / at) * from + (y / at) * to;
    };
    beam = {narrowed(beam.x, through(own_x, about(hole.x0, size.x), slope.x)),
            narrowed(beam.z, through(own_z, about(hole.z0, size.z), slope.z))};
  };
  for (const Plane& plane : sections.planes) {
    if (!(plane.y > 0)) continue;
    if (const auto* plate = std::get_if<PlateTerm>(&plane.term)) {
      const Aperture hole = aperture_of(plane.y, *plate);
      if (!hole.stops_inside) passes(plane.y, hole);
    }
    const auto* screen = std::get_if<ScreenTerm>(&plane.term);
    // Behind parallel lines what is pushed there need not have started in front of it.
    if (screen != nullptr && angle > 0)
      passes(plane.y, aperture_of(plane.y, extent_of(screen->face), screen->offset));
  }
  return beam;
}

}  // namespace rabiline
