#include "plan/level_ways.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <span>

#include "core/portable_math.hpp"
#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "plan/beam.hpp"
#include "plan/level_exchange.hpp"
#include "plan/level_waves.hpp"
#include "plan/zones.hpp"

namespace rabiline {
namespace {

double speed_of(const Beamline& beamline, const Species& species) {
  return mean_speed(beamline.source.speed, species.mass);
}

/// What passes for a species with gamma = -1 rad/(s T) sees fields in tesla as rates.
Species in_tesla(const Species& atom) {
  Species species = atom;
  species.structure.reset();
  species.charge = 0;
  species.gyromagnetic_ratio = -1;
  return species;
}

/// The whole fields of some clocks.
Section whole_fields(Section section, const std::set<int>& clocks, bool of_these) {
  std::erase_if(section.rotating, [&](const RotatingTerm& term) {
    return term.amplitude == 0 || clocks.contains(term.oscillator.part) != of_these;
  });
  for (RotatingTerm& term : section.rotating)
    if (term.motion == FieldMotion::swings_in_rotating_wave) term.motion = FieldMotion::swings;
  return section;
}

bool has_field(const Section& section) {
  return section.field != Vector3{} || section.has_shaped_fields() ||
         std::ranges::any_of(section.rotating, [](const RotatingTerm& term) { return term.amplitude != 0; });
}

/// [T] On the axis, of what stands still.
Vector3 still_field(const Section& section, double y) {
  FieldHere<double> here{};
  for (const ShapedTerm& term : section.shaped)
    if (!term.moves()) add_field<HostMaths>(term, 0.0, y, 0.0, here);
  return section.field + Vector3{here.field[0], here.field[1], here.field[2]};
}

/// [T] The most by which a static field turns at once where two sections that have one touch, or the last one
/// and the field along +z behind it: the weaker of them (LevelCourse).
double largest_turn(const std::vector<Section>& sections, double from, double to, double behind) {
  double most = 0;
  const auto meet = [&](const Vector3& before, const Vector3& next) {
    const double b = length_of(before), c = length_of(next);
    if (b > 0 && c > 0) most = std::max(most, std::min(b, c) * length_of((1 / b) * before - (1 / c) * next));
  };
  constexpr double hair = 1e-9;  // [m] rounding would find a map's field absent at its face
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const double edge = std::min(sections[i].end, to);
    if (edge <= from || sections[i].begin >= to) continue;
    if (edge >= to - no_length)
      meet(still_field(sections[i], edge - hair), {0, 0, behind});
    else if (i + 1 < sections.size() && sections[i + 1].begin <= edge + no_length)
      meet(still_field(sections[i], edge - hair), still_field(sections[i + 1], edge + hair));
  }
  return most;
}

/// Whether the static field at a place, on one side of it, turns spins by a hundredth of a radian before its
/// direction is another one or it ends: what is too weak for that, as the tail of a fringe far away, gives
/// levels no axis.
bool is_felt(const std::vector<Section>& sections, double place, double side, const CoupledSpins& spins,
             double speed) {
  constexpr int places = 2000;
  constexpr double hair = 1e-9, another = 0.5, felt = 0.01;  // [m], [rad], [rad]
  const auto field_at = [&](double y) {
    for (const Section& section : sections)
      if (y >= section.begin && y < section.end) return still_field(section, y);
    return Vector3{};
  };
  const double turn =
      2 * std::numbers::pi * std::max(std::abs(spins.zeeman_j), std::abs(spins.zeeman_i)) / speed;
  const double first = sections.front().begin, last = sections.back().end, step = (last - first) / places;
  Vector3 axis{};
  double angle = 0;
  const auto walk = [&](double direction) {
    for (double y = place + side * hair; y > first - hair && y < last && angle < felt;
         y += direction * step) {
      const Vector3 b = field_at(y);
      const double size = length_of(b);
      if (size == 0 && axis != Vector3{}) return;
      if (size == 0) continue;
      if (axis == Vector3{}) axis = (1 / size) * b;
      if (length_of((1 / size) * b - axis) > another) return;
      angle += turn * size * step;
    }
  };
  walk(side);
  walk(-side);
  return angle >= felt;
}

}  // namespace

bool needs_way(const Section& section) {
  int drives = 0;
  for (const RotatingTerm& term : section.rotating) {
    if (term.amplitude == 0) continue;
    if (!has_standing_frame(term)) return true;
    ++drives;
  }
  return drives > 1 || section.has_shaped_fields() || section.field.x != 0 || section.field.y != 0;
}

bool needs_way(const std::vector<Section>& sections, double from, double to) {
  // What stands at either end has a field along +z. Where one against it meets one along it, levels do not
  // keep their names.
  double end_before = from, field_before = 1;
  for (const Section& section : sections) {
    const double begin = std::max(section.begin, from), end = std::min(section.end, to);
    if (begin + no_length >= end) continue;
    const double field = section.field.z;
    const bool meets = begin <= end_before + no_length && field != 0 && field_before != 0;
    const bool turns_round = meets && (field > 0) != (field_before > 0);
    const bool ends_against = end >= to - no_length && field < 0;
    if (needs_way(section) || turns_round || ends_against) return true;
    end_before = end;
    field_before = field;
  }
  return false;
}

LevelFields level_fields(const Beamline& beamline, const Species& species,
                         const std::vector<Section>& sections, double from, double to, double behind) {
  const Species unit = in_tesla(species);
  const double speed = speed_of(beamline, species);
  const ZoneMaker zones(unit, unit, {}, speed, 0);
  const CoupledSpins spins = coupled_spins(*species.structure);
  LevelFields out;
  out.tolerance = law_traits(beamline.law).tolerance;
  const std::set<int> waves = clocks_of_waves(sections, from, to, zones, spins, most_cycles);
  int periods = 0;
  std::vector<Section> driven;  // by waves
  for (const Section& section : sections) {
    const double begin = std::max(section.begin, from), end = std::min(section.end, to);
    if (begin + no_length >= end || !has_field(section)) continue;
    CourseSection part;
    part.field = zones.zone_of(whole_fields(section, waves, false));
    part.field.begin = begin;
    part.field.end = end;
    part.shaped_begin = static_cast<int>(out.shaped.size());
    zones.add_shaped_fields(section, part.field, out.shaped);
    part.shaped_end = static_cast<int>(out.shaped.size());
    part.has_courses = std::ranges::any_of(section.shaped, &ShapedTerm::moves);
    for (int i = 0; i < part.field.drives; ++i)
      part.fastest = std::max(part.fastest, angular_frequency(part.field.drive[i], speed));
    part.is_pulsed = std::ranges::any_of(section.rotating, [](const RotatingTerm& term) {
      return term.amplitude != 0 && term.gate != Gate{};
    });
    if (part.field.drives > 0 && part.is_pulsed) part.fastest = std::max(part.fastest, speed / (end - begin));
    if (Section wave = whole_fields(section, waves, true); !wave.rotating.empty()) {
      wave.begin = begin;
      wave.end = end;
      part.wave = static_cast<int>(driven.size());
      driven.push_back(std::move(wave));
    }
    if (part.wave < 0 && repeats(section, end - begin, zones, spins)) part.period = periods++;
    const bool is_uniform = part.shaped_begin == part.shaped_end && part.field.drives == 0 && part.wave < 0;
    part.longest = (end - begin) / (is_uniform ? 1 : 8);
    out.sections.push_back(part);
  }
  out.apart = far_apart(species, out, speed, largest_turn(sections, from, to, behind), beamline.source);
  const std::vector<int> manifolds = manifolds_of(spins, out.apart);
  for (const CourseSection& part : out.sections) {
    if (part.wave < 0) continue;
    const Section& section = driven[static_cast<std::size_t>(part.wave)];
    double swinging = 0;
    for (const DriveTerm& drive : std::span(part.field.drive, static_cast<std::size_t>(part.field.drives)))
      swinging += std::abs(drive.spin_rate) * angular_frequency(drive, speed);
    Section alone = section;
    alone.field = {};
    const auto rate = [&](double y) {
      const Passing passing = passing_at(out, part, y, speed, beamline.source);
      return swinging + passing.courses + passing.growth + passing.swinging;
    };
    out.waves.push_back(wave_fields(zones.zone_of(alone), section, species, manifolds, speed,
                                    beamline.source.offset, {rate, part.fastest / (2 * std::numbers::pi)}));
  }
  const bool begins = out.sections.front().field.begin <= from + no_length,
             ends = out.sections.back().field.end >= to - no_length;
  out.begins_in_field = begins && is_felt(sections, from, 1, spins, speed);
  out.ends_in_field = ends && is_felt(sections, to, -1, spins, speed);
  out.begins_too_weak = begins && !out.begins_in_field;
  out.ends_too_weak = ends && !out.ends_in_field;
  out.behind = behind;
  return out;
}

double cycles_in(const CourseSection& section, double speed) {
  if (section.period >= 0) return 0;
  return section.fastest / (2 * std::numbers::pi) * (section.field.end - section.field.begin) / speed;
}

}  // namespace rabiline
