#include "plan/level_history.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/portable_math.hpp"

namespace rabiline {
namespace {

/// [m] Where parts touch, rounding may leave a section of this length between them.
constexpr double rounding = 1e-12;

/// What drives levels: a rule refuses everything else.
[[maybe_unused]] bool can_drive(const RotatingTerm& term) {
  if (term.twist != 0 || term.motion == FieldMotion::swings) return false;
  if (term.motion == FieldMotion::swings_in_rotating_wave) return true;
  return term.first == Vector3{1, 0, 0} && term.second == Vector3{0, 1, 0} &&
         (term.oscillator.turn == Turn::positive || term.oscillator.turn == Turn::negative);
}

LevelZone zone_of(const Section& section) {
  assert(section.coils.empty() && section.field.x == 0 && section.field.y == 0 && section.field.z >= 0);
  LevelZone zone;
  zone.begin = section.begin;
  zone.end = section.end;
  zone.field = section.field.z;
  for (const RotatingTerm& term : section.rotating) {
    if (term.amplitude == 0) continue;
    assert(!zone.drive && can_drive(term));
    zone.drive = term;
  }
  return zone;
}

// ---- directions ----

/// Beyond this many standard deviations is less than 1e-4.
constexpr double deviations = 4;
/// Nothing is told apart beyond this angle [rad].
constexpr double widest = 1.3;

/// How far the rim is from the centre.
double reach_of(const Rectangle& hole) { return portable::hypot(hole.width, hole.height) / 2; }
double reach_of(const Disc& hole) { return hole.radius; }
double reach_of(const Ring& hole) { return hole.outer_radius; }
double reach_of(const GaussianSpot& spot) { return deviations * portable::hypot(spot.sigma_x, spot.sigma_z); }
template <class... Holes>
double reach_of(const std::variant<Holes...>& hole) {
  return std::visit([](const auto& h) { return reach_of(h); }, hole);
}

}  // namespace

std::vector<LevelZone> driven_zones(const std::vector<Section>& sections, double from, double to) {
  std::vector<LevelZone> zones;
  std::size_t last = 0;
  for (const Section& section : sections) {
    if (std::max(section.begin, from) + rounding >= std::min(section.end, to)) continue;
    LevelZone zone = zone_of(section);
    zone.begin = std::max(zone.begin, from);
    zone.end = std::min(zone.end, to);
    const bool driven = zone.drive.has_value();
    if (!driven && zones.empty()) continue;  // only phases before the first drive
    zones.push_back(zone);
    if (driven) last = zones.size();
  }
  zones.resize(last);
  return zones;
}

double steepest_before(const Plane& asked, const Beamline& beamline, const Sections& sections) {
  const Source& source = beamline.source;
  const double tilt =
      portable::acos(std::clamp(portable::cos(source.tilt.x) * portable::cos(source.tilt.z), -1.0, 1.0));
  const double law =
      std::visit([](const auto& l) { return l.widest_angle(deviations); }, source.direction) + tilt;
  if (law == 0) return 0;
  const double hole = reach_of(source.opening) + portable::hypot(source.offset.x, source.offset.z);
  double slope = std::numeric_limits<double>::infinity();
  const auto pass = [&](double y, double reach) {
    if (y > 0) slope = std::min(slope, (reach + hole) / y);
  };
  for (const PlacedPart& part : beamline.parts)
    if (const auto* aimed = std::get_if<AimedDirection>(&source.direction);
        aimed != nullptr && part.placement.name == aimed->target) {
      const Across across = across_of(part.part).value();
      pass(part.placement.at, reach_of(across.opening) + portable::hypot(across.offset.x, across.offset.z));
    }
  // What a magnet bends keeps its speed along the beam.
  for (const Plane& plane : sections.planes) {
    if (std::holds_alternative<MagnetTerm>(plane.term) || plane.y > asked.y) break;
    if (beamline.chamber) pass(plane.y, beamline.chamber->radius);
    const auto* plate = std::get_if<PlateTerm>(&plane.term);
    if (plate != nullptr && !plate->stops_inside)
      pass(plane.y, reach_of(plate->opening) + portable::hypot(plate->offset.x, plate->offset.z));
    const auto* screen = std::get_if<ScreenTerm>(&plane.term);
    if (screen != nullptr && &plane == &asked)
      pass(plane.y, reach_of(opening_of(screen->face)) + portable::hypot(screen->offset.x, screen->offset.z));
  }
  return std::min({law, portable::atan(slope), widest});
}

SlownessRange slownesses_of(const Source& source, double mass, double steepest) {
  const SpeedRange speeds = std::visit([&](const auto& law) { return law.speed_range(mass); }, source.speed);
  // What flies aslant goes more slowly along the beam; in steps, so that scan points share their tables.
  constexpr double step = 0.02;
  const double longer = 1 + step * std::ceil((1 / portable::cos(steepest) - 1) / step);
  return {1 / speeds.fastest, longer / speeds.slowest};
}

}  // namespace rabiline
