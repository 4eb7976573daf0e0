#include "plan/level_history.hpp"

#include <algorithm>
#include <cassert>

namespace rabiline {
namespace {

/// [m] Where parts touch, rounding may leave a section of this length between them.
constexpr double rounding = 1e-12;

LevelZone zone_of(const Section& section) {
  assert(section.coils.empty() && section.field.x == 0 && section.field.y == 0);
  LevelZone zone;
  zone.begin = section.begin;
  zone.end = section.end;
  zone.field = section.field.z;
  for (const RotatingTerm& term : section.rotating) {
    if (term.amplitude == 0) continue;
    assert(!zone.drive && has_standing_frame(term));
    zone.drive = term;
    zone.part = term.part;
  }
  return zone;
}

}  // namespace

bool has_standing_frame(const RotatingTerm& term) {
  if (term.twist != 0 || term.motion == FieldMotion::swings) return false;
  if (term.oscillator.sweep != Sweep{} || term.gate != Gate{} || term.slopes != Slopes{}) return false;
  if (term.motion == FieldMotion::swings_in_rotating_wave) return true;
  return term.first == Vector3{1, 0, 0} && term.second == Vector3{0, 1, 0} &&
         (term.oscillator.turn == Turn::positive || term.oscillator.turn == Turn::negative);
}

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

}  // namespace rabiline
