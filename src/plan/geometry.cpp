#include "plan/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/portable_math.hpp"

namespace rabiline {
namespace {

/// By how much a round opening, or a point where its radius is 0, comes beyond the walls of another one.
double lies_beyond(const Aperture& a, double x, double z, double radius) {
  const double dx = x - a.x0, dz = z - a.z0;
  if (a.radius >= 0) return portable::hypot(dx, dz) + radius - a.radius;
  return std::max(std::abs(dx * a.cosine - dz * a.sine) + radius - a.half_x,
                  std::abs(dx * a.sine + dz * a.cosine) + radius - a.half_z);
}

}  // namespace

Aperture aperture_of(double y, const Opening& opening, const Offset& offset, const Roll& roll) {
  Aperture a;
  a.y = y;
  a.x0 = offset.x;
  a.z0 = offset.z;
  if (const auto* disc = std::get_if<Disc>(&opening)) {
    a.radius = disc->radius;
  } else if (const auto* ring = std::get_if<Ring>(&opening)) {
    a.radius = ring->outer_radius;
    a.inner = ring->inner_radius;
  } else {
    a.half_x = std::get<Rectangle>(opening).width / 2;
    a.half_z = std::get<Rectangle>(opening).height / 2;
    if (roll.y != 0) {
      a.cosine = portable::cos(roll.y);
      a.sine = portable::sin(roll.y);
    }
  }
  return a;
}

Aperture aperture_of(double y, const PlateTerm& plate) {
  Aperture aperture = aperture_of(y, plate.opening, plate.offset, plate.tilt);
  aperture.stops_inside = plate.stops_inside;
  return aperture;
}

double area_of(const Aperture& a) {
  return a.radius >= 0 ? std::numbers::pi * (a.radius * a.radius - a.inner * a.inner)
                       : 4 * a.half_x * a.half_z;
}

bool lies_in(const Aperture& inner, const Aperture& outer) {
  if (inner.radius >= 0) return lies_beyond(outer, inner.x0, inner.z0, inner.radius) <= 0;
  for (const double across : {-inner.half_x, inner.half_x})
    for (const double up : {-inner.half_z, inner.half_z})
      if (lies_beyond(outer, inner.x0 + across * inner.cosine + up * inner.sine,
                      inner.z0 + up * inner.cosine - across * inner.sine, 0) > 0)
        return false;
  return true;
}

Rectangle extent_of(const Face& face) {
  if (const auto* disc = std::get_if<Disc>(&face)) return {2 * disc->radius, 2 * disc->radius};
  return std::get<Rectangle>(face);
}

ScreenGrids screen_grids(const ScanPoints& points) {
  struct Seen {
    Offset offset;
    double width = 0, height = 0;
    bool moves = false;
  };
  std::map<std::string, Seen> seen;
  for (const Beamline& beamline : points)
    for (const PlacedPart& part : beamline.parts) {
      const auto* d = detector_in(part.part);
      if (d == nullptr) continue;
      const Rectangle size = extent_of(d->face);
      Seen& screen = seen.try_emplace(part.placement.name, Seen{d->offset}).first->second;
      screen.width = std::max(screen.width, size.width);
      screen.height = std::max(screen.height, size.height);
      screen.moves = screen.moves || !(d->offset == screen.offset);
    }
  ScreenGrids grids;
  for (const auto& [name, screen] : seen) {
    const Offset centre = screen.moves ? Offset{} : screen.offset;
    grids[name] = {centre.x - screen.width / 2, centre.x + screen.width / 2, centre.z - screen.height / 2,
                   centre.z + screen.height / 2, screen.moves};
  }
  return grids;
}

Screen screen_of(double y, int part, const ScreenTerm& term, const ScreenGrid& grid) {
  Screen s;
  s.y = y;
  s.part = part;
  s.x0 = term.offset.x;
  s.z0 = term.offset.z;
  const Aperture rim = aperture_of(y, opening_of(term.face), term.offset, term.tilt);
  s.half_x = extent_of(term.face).width / 2;
  s.half_z = extent_of(term.face).height / 2;
  s.radius = rim.radius;
  if (term.tilt.y != 0) {
    s.cosine = portable::cos(term.tilt.y);
    s.sine = portable::sin(term.tilt.y);
  }
  s.efficiency = term.efficiency;
  if (term.dead) {
    s.has_dead_area = true;
    s.dead = aperture_of(y, term.dead->opening, term.dead->offset, term.dead->tilt);
  }
  s.bins_x = term.bins_x;
  s.bins_z = term.bins_z;
  s.low_x = grid.low_x + (grid.moves ? term.offset.x : 0);
  s.low_z = grid.low_z + (grid.moves ? term.offset.z : 0);
  s.bins_per_x = term.bins_x / (grid.high_x - grid.low_x);
  s.bins_per_z = term.bins_z / (grid.high_z - grid.low_z);
  return s;
}

HalfSizes halves_of(const SourceOpening& opening) {
  if (const auto* spot = std::get_if<GaussianSpot>(&opening)) return {spot->sigma_x, spot->sigma_z};
  if (const auto* disc = std::get_if<Disc>(&opening)) return {disc->radius, disc->radius};
  if (const auto* ring = std::get_if<Ring>(&opening)) return {ring->outer_radius, ring->outer_radius};
  const auto& hole = std::get<Rectangle>(opening);
  return {hole.width / 2, hole.height / 2};
}

}  // namespace rabiline
