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
#include "plan/geometry.hpp"
#include "plan/level_history.hpp"
#include "plan/level_waves.hpp"
#include "plan/zones.hpp"

namespace rabiline {
namespace {

/// [m] Where parts touch, rounding may leave a section of this length between them.
constexpr double no_length = 1e-12;

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

bool is_pulsed(const DriveTerm& drive) { return drive.gate.begin != drive.gate.end; }

/// By which part of its highest size a drive is switched at once, at its edges or by pulses, as often as a
/// particle meets that.
double jump_of(const DriveTerm& drive, double stay) {
  const Envelope& e = drive.envelope;
  if (is_pulsed(drive))
    return std::sqrt(std::clamp(stay / std::max(drive.gate.period, drive.gate.end - drive.gate.begin), 1.0,
                                drive.gate.times));
  constexpr double inside = 1e-9;
  return std::max(std::abs(share_of(e, e.begin + inside * e.length)),
                  std::abs(share_of(e, e.begin + (1 - inside) * e.length)));
}

/// [1/s] No less than what a course changes by: the slope of a B-spline is a mean of the differences of its
/// coefficients.
double fastest_rate(const TimeCourse& course) {
  double most = 0;
  for (int i = 0; course.nodes > 0 && i <= course.nodes; ++i)
    most = std::max(most, std::abs(course.coefficients[i + 1] - course.coefficients[i]));
  return most * course.per_second;
}

/// The size of a course, at the most.
double largest_of(const TimeCourse& course) {
  double most = 0;
  for (int i = 0; course.nodes > 0 && i < course.nodes + 2; ++i)
    most = std::max(most, std::abs(course.coefficients[i]));
  return most;
}

/// [m] Where particles fly at y: the middle of those that go on as the source's axis does, and the corners.
std::vector<Offset> flown_at(const Source& source, double y) {
  const HalfSizes half = halves_of(source.opening);
  const Offset middle = axis_of_beam(source, y);
  std::vector<Offset> out{middle};
  for (const double x : {-half.x, half.x})
    for (const double z : {-half.z, half.z}) out.push_back({middle.x + x, middle.z + z});
  return out;
}

/// What a particle passes at one place; of a static field in the middle of the beam.
struct Passing {
  Vector3 rate;                               // [T/s] of the static field
  double size = 0;                            // [T] likewise
  double courses = 0;                         // [T/s] of what goes through a course
  double peak = 0, growth = 0, swinging = 0;  // [T] of what moves, [T/s] along the way and in time
};
Passing passing_at(const LevelFields& fields, const CourseSection& section, double y, double speed,
                   const Source& source) {
  Passing out;
  const std::vector<Offset> flown = flown_at(source, y);
  const auto growth_of = [&](const FieldHere<double>& field) {
    return speed * portable::hypot(field.slope[1], field.slope[4], field.slope[7]);
  };
  FieldHere<double> still{};
  for (int i = section.shaped_begin; i < section.shaped_end; ++i) {
    const ShapedTerm& term = fields.shaped[static_cast<std::size_t>(i)];
    if (!term.moves()) {
      add_field<HostMaths>(term, flown.front().x, y, flown.front().z, still);
      continue;
    }
    double size = 0, growth = 0;
    for (const Offset& place : flown) {
      FieldHere<double> peak{};
      add_field<HostMaths>(term, place.x, y, place.z, peak);
      size = std::max(size, portable::hypot(peak.field[0], peak.field[1], peak.field[2]));
      growth = std::max(growth, growth_of(peak));
    }
    if (term.drive < 0) {
      out.courses += size * fastest_rate(term.course);
      out.peak += size * largest_of(term.course);
      out.growth += growth * largest_of(term.course);
      continue;
    }
    out.peak += size;
    out.growth += growth;
    out.swinging += size * section.field.drive[term.drive].omega;
  }
  out.size =
      portable::hypot(still.field[0], still.field[1], still.field[2]) + std::abs(section.field.spin_rate);
  out.rate = speed * Vector3{still.slope[1], still.slope[4], still.slope[7]};
  return out;
}

/// How little dB/dt changes evenly along the way.
class Roughness {
 public:
  /// A section with what the beam passes, from its begin to its end in steps of `time` [s]; `touches`: the
  /// one before.
  void pass(const std::vector<Passing>& places, double time, bool touches) {
    if (!touches) jump_to({});
    jump_to(places.front().rate);
    for (std::size_t i = 1; i < places.size(); ++i)
      changes_ += length_of(places[i].rate - places[i - 1].rate);
    for (const Passing& here : places) largest_ = std::max(largest_, here.size);
    last_ = places.back().rate;
    const double fine = bends_of(places, 1) / time, coarse = bends_of(places, 2) / (2 * time);
    // Of steps twice as much on half as long a way; a section without any is taken for one, on the safe side.
    is_smooth_ = is_smooth_ && fine < 1.5 * coarse;
    bends_ += fine;
  }
  void stop() { jump_to({}); }
  /// [Hz] How far F are apart that exchange no more than an amplitude, with an element [Hz/T] between them:
  /// the integral of dB/dt exp(i w t) is, by parts, at most what dB/dt changes by over w; or what it jumps
  /// by, and what its slope changes by over w^2, while w is far above what the field splits F by.
  double apart(double element, double amplitude) const {
    const double share = element / (2 * std::numbers::pi * amplitude),
                 cube = share * bends_ / (2 * std::numbers::pi),
                 of_changes = std::sqrt(share * (jumps_ + changes_));
    if (!is_smooth_ || cube == 0) return of_changes;
    const double of_bends = std::sqrt(share * jumps_) + portable::pow(cube, 1.0 / 3);
    return std::min(of_changes, std::max(of_bends, strong_ * element * largest_));
  }

 private:
  void jump_to(const Vector3& rate) {
    jumps_ += length_of(rate - last_);
    last_ = rate;
  }
  /// By how much differences change in all, from none to none, over so many steps.
  static double bends_of(const std::vector<Passing>& places, std::size_t stride) {
    Vector3 before;
    double sum = 0;
    for (std::size_t i = stride; i < places.size(); i += stride) {
      const Vector3 slope = places[i].rate - places[i - stride].rate;
      sum += length_of(slope - before);
      before = slope;
    }
    return sum + length_of(before);
  }

  static constexpr double strong_ = 10;
  double jumps_ = 0, changes_ = 0, bends_ = 0, largest_ = 0;  // [T/s], [T/s], [T/s^2], [T]
  bool is_smooth_ = true;
  Vector3 last_;
};

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

/// By which energies F must differ to exchange nothing (level_fields), where static fields turn at once by
/// `turned` [T] at most.
double far_apart(const Species& species, const LevelFields& fields, double speed, double turned,
                 const Source& source) {
  constexpr int places = 256;
  double courses = 0, driving = 0, switching = turned, frequency = 0;  // [T/s], [T/s], [T], [Hz]
  Roughness roughness;
  double end_before = -1;
  for (const CourseSection& section : fields.sections) {
    double drives = 0, jumps = 0, swings = 0, leaps = 0;
    for (int i = 0; i < section.field.drives; ++i) {
      const DriveTerm& drive = section.field.drive[i];
      jumps += std::abs(drive.spin_rate) * jump_of(drive, (section.field.end - section.field.begin) / speed);
      drives += std::abs(drive.spin_rate) * angular_frequency(drive, speed);
      frequency = std::max(frequency, angular_frequency(drive, speed) / (2 * std::numbers::pi));
    }
    const double begin = section.field.begin + section.hair(), end = section.field.end - section.hair(),
                 step = (end - begin) / places;
    std::vector<Passing> passed;
    Passing last;
    for (int place = 0; place <= places; ++place) {
      const Passing here = passing_at(fields, section, begin + place * step, speed, source);
      passed.push_back(here);
      courses = std::max(courses, here.courses);
      swings = std::max(swings, here.swinging + here.growth);
      // More than it grows by, at its ends or the faces of a map.
      leaps = std::max(leaps,
                       std::abs(here.peak - last.peak) - step / speed * std::max(here.growth, last.growth));
      last = here;
    }
    leaps = std::max(leaps, last.peak - step / speed * last.growth);
    driving = std::max(driving, drives + swings);
    switching = std::max(switching, jumps + leaps);
    roughness.pass(passed, step / speed, section.field.begin < end_before + no_length);
    end_before = section.field.end;
  }
  roughness.stop();
  // What drives does so for long.
  const CoupledSpins spins = coupled_spins(*species.structure);
  // <F'|J|F> is at most the smaller of I and J, near enough.
  const double moment = std::abs(spins.zeeman_j - spins.zeeman_i) * std::min(spins.twice_i, spins.twice_j),
               root = std::sqrt(fields.tolerance), share = moment / (2 * std::numbers::pi * root);
  // A field that is there at once leaves each level with b moment/2 over what F are apart of the other F.
  return std::max({roughness.apart(moment / 2, 0.4 * root), std::sqrt(2.5 * courses * share),
                   std::sqrt(10 * driving * share), switching * moment / root, 2 * frequency});
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
  LevelFields out;
  out.tolerance = law_traits(beamline.law).tolerance;
  const std::set<int> waves = clocks_of_waves(sections, from, to, zones, most_cycles);
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
    const bool is_uniform = part.shaped_begin == part.shaped_end && part.field.drives == 0 && part.wave < 0;
    part.longest = (end - begin) / (is_uniform ? 1 : 8);
    out.sections.push_back(part);
  }
  out.apart = far_apart(species, out, speed, largest_turn(sections, from, to, behind), beamline.source);
  const CoupledSpins spins = coupled_spins(*species.structure);
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
  return section.fastest / (2 * std::numbers::pi) * (section.field.end - section.field.begin) / speed;
}

}  // namespace rabiline
