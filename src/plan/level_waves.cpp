#include "plan/level_waves.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <span>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "plan/period.hpp"
#include "plan/zones.hpp"
#include "spin/level_period.hpp"
#include "spin/levels.hpp"
#include "spin/rotating_frame.hpp"

namespace rabiline {
namespace {

using constants::two_pi;
/// Along a section: a resonance between two of them is still within the coupling of what would matter.
constexpr int places_of_frame = 129;

double place_in(double begin, double end, int number) {
  return begin + (number + 0.5) / places_of_frame * (end - begin);
}

/// What acts as a static field beside the axis, and how it changes along the beam.
struct FieldBeside {
  Vector3 here, slope;  // [T], [T/m]
};
/// Of a section's uniform field and its terms, at the time t [s] of those with a course.
FieldBeside static_field(const Vector3& uniform, std::span<const ShapedTerm> shaped, const Offset& beside,
                         double y, double t) {
  FieldHere<double> here{};
  for (const ShapedTerm& term : shaped)
    if (term.drive < 0) add_field_at<HostMaths>(term, beside.x, y, beside.z, t, here);
  return {uniform + Vector3{here.field[0], here.field[1], here.field[2]},
          {here.slope[1], here.slope[4], here.slope[7]}};
}

/// Of a field a cos p + b sin p, p its angle, in axes along a static one, whose direction is `third`.
DriveParts parts_about(const Vector3& third, const Vector3& a, const Vector3& b) {
  const Vector3 first = some_normal(third), second = cross(third, first);
  constexpr double negligible = 1e-12;  // of the square of its size
  return {portable::hypot(dot(a, first) + dot(b, second), dot(b, first) - dot(a, second)) / 2,
          portable::hypot(dot(a, first) - dot(b, second), dot(b, first) + dot(a, second)) / 2,
          portable::hypot(dot(a, third), dot(b, third)),
          length_of(cross(a, b)) <= negligible * (dot(a, a) + dot(b, b))};
}

/// A drive's amplitudes at the angles 0 and 90 degrees, over its size; left-handed ones have a negative
/// frequency.
std::pair<Vector3, Vector3> quadratures(const DriveTerm& drive) {
  const double sense = drive.omega < 0 ? -1 : 1;
  return {Vector3{drive.first[0], drive.first[1], drive.first[2]},
          sense * Vector3{drive.second[0], drive.second[1], drive.second[2]}};
}

/// What drives, in axes along a static field.
WavePlace place_of(std::span<const DriveTerm> drives, const FieldBeside& there, double speed, double moving) {
  WavePlace out;
  const Vector3& field = there.here;
  out.field = length_of(field);
  if (out.field > 0) out.turning = (speed * length_of(there.slope) + moving) / out.field;
  const Vector3 third = out.field > 0 ? (1 / out.field) * field : Vector3{0, 0, 1};
  for (const DriveTerm& drive : drives) {
    const auto [a, b] = quadratures(drive);
    const DriveParts parts = parts_about(third, a, b);
    const double size = std::abs(drive.spin_rate);
    out.lowering += size * (2 * parts.left);
    out.raising += size * (2 * parts.right);
    out.along += size * parts.along;
  }
  return out;
}

/// While a particle passes, at the most.
double pulses_in(const Gate& gate, double time) {
  return gate.begin == gate.end || gate.period == 0 ? 1 : std::min(gate.times, std::ceil(time / gate.period));
}

/// A drive that comes nearest to a difference of levels that it couples: at which of the frequencies that it
/// sweeps through, and how far from it [Hz].
struct NearestLine {
  double distance = std::numeric_limits<double>::infinity(), frequency = 0;
};
NearestLine nearest_line(const CoupledSpins& spins, double field, const DriveParts& parts, double first,
                         double swept) {
  const DrivenStates states = driven_states(spins, levels_at(spins, field), parts);
  const double last = std::abs(first + swept);
  NearestLine nearest{.frequency = first};
  for (int i = 0; i < spins.levels(); ++i)
    for (int j = 0; j < i; ++j) {
      if (states.up(i, j) == 0 && states.up(j, i) == 0) continue;
      const double line = std::abs(states.energy(i) - states.energy(j)),
                   frequency = std::clamp(line, std::min(first, last), std::max(first, last));
      if (std::abs(line - frequency) < nearest.distance) nearest = {std::abs(line - frequency), frequency};
    }
  return nearest;
}

}  // namespace

double angular_frequency(const DriveTerm& drive, double speed) {
  double rate = std::max(std::abs(drive.omega), std::abs(drive.omega + swept_in_all(drive))) +
                std::abs(drive.twist) * speed;
  if (drive.envelope.shape == Shape::gaussian) rate += speed / drive.envelope.sigma;
  if (drive.envelope.shape == Shape::half_sine) rate += std::numbers::pi * speed / drive.envelope.length;
  if (drive.envelope.shape == Shape::standing_wave)
    rate += drive.envelope.half_waves * std::numbers::pi * speed / drive.envelope.length;
  return rate;
}

bool repeats(const Section& section, double length, const ZoneMaker& zones, const CoupledSpins& spins) {
  constexpr double fewest_periods = 30, for_each = 5e-4, longest = 5;  // [s]
  if (section.has_shaped_fields()) return false;
  Section driven = section;
  std::erase_if(driven.rotating, [](const RotatingTerm& term) { return term.amplitude == 0; });
  if (std::ranges::any_of(driven.rotating, [](const RotatingTerm& term) {
        return term.motion == FieldMotion::swings_in_rotating_wave && term.oscillator.frequency != 0;
      }))
    return false;
  const SpinZone zone = zones.zone_of(driven);
  if (!has_one_clock(zone)) return false;
  double driving = 0;
  for (int i = 0; i < zone.drives; ++i) driving += std::abs(zone.drive[i].spin_rate);
  const double omega = zone.drive[0].omega, periods = length / zones.speed() * std::abs(omega) / two_pi;
  return periods > fewest_periods && time_for_period(spins, length_of(section.field), driving, omega) <
                                         std::min(for_each * periods, longest);
}

std::set<int> clocks_of_waves(const std::vector<Section>& sections, double from, double to,
                              const ZoneMaker& zones, const CoupledSpins& spins, double periods) {
  struct Clock {
    int part = 0;
    double frequency = 0, periods = 0;
  };
  std::vector<Clock> turning;
  std::set<int> out;
  double whole = 0;
  for (const Section& section : sections) {
    const double length = std::min(section.end, to) - std::max(section.begin, from);
    if (repeats(section, length, zones, spins)) continue;
    double fastest = 0;  // [Hz] of what swings
    for (const SwingingTerm& term : section.swinging) fastest = std::max(fastest, term.oscillator.frequency);
    whole += std::max(0.0, fastest * length / zones.speed());
    for (const RotatingTerm& term : section.rotating) {
      const int part = term.oscillator.part;
      if (length <= 0 || term.amplitude == 0) continue;
      if (term.motion == FieldMotion::swings_in_rotating_wave && term.oscillator.frequency != 0)
        out.insert(part);
      if (out.contains(part)) continue;
      Section alone;
      alone.rotating = {term};
      const double frequency = angular_frequency(zones.zone_of(alone).drive[0], zones.speed()) / two_pi,
                   turns = frequency * length / zones.speed();
      whole += turns;
      if (term.motion != FieldMotion::turns || term.oscillator.frequency == 0) continue;
      auto clock = std::ranges::find(turning, part, &Clock::part);
      if (clock == turning.end()) clock = turning.insert(clock, {part, frequency, 0});
      clock->periods += turns;
    }
  }
  std::ranges::stable_sort(turning, std::ranges::greater(), &Clock::frequency);
  for (const Clock& clock : turning) {
    if (whole <= periods) break;
    out.insert(clock.part);
    whole -= clock.periods;
  }
  return out;
}

WaveFields wave_fields(const SpinZone& drives, const Section& section, const Species& atom,
                       const std::vector<int>& manifold_of, double speed, const Offset& beam,
                       const MovingFields& moving) {
  WaveFields out;
  out.drives.assign(drives.drive, drives.drive + drives.drives);
  const auto frequency_of = [](const DriveTerm& drive) { return std::abs(drive.omega) / two_pi; };
  out.frequency = frequency_of(out.drives.front());
  std::vector<WaveAlong> waves;
  for (const DriveTerm& drive : out.drives) {
    WaveAlong wave{frequency_of(drive)};
    if (std::ranges::find(waves, wave.frequency, &WaveAlong::frequency) != waves.end()) continue;
    std::vector<DriveTerm> alike;
    std::ranges::copy_if(out.drives, std::back_inserter(alike),
                         [&](const DriveTerm& other) { return frequency_of(other) == wave.frequency; });
    for (int i = 0; i < places_of_frame; ++i) {
      const double y = place_in(section.begin, section.end, i);
      wave.places.push_back(place_of(alike, static_field(section.field, section.shaped, beam, y, y / speed),
                                     speed, moving.rate(y)));
      wave.places.back().fastest = moving.fastest;
      if (section.shaped.empty() && section.swinging.empty()) break;
    }
    waves.push_back(std::move(wave));
  }
  const double time = (section.end - section.begin) / speed;
  out.frame = wave_frame(coupled_spins(*atom.structure), manifold_of, waves, time);
  // What is left out at each edge of a pulse adds up.
  double pulses = 1;
  for (const DriveTerm& drive : out.drives) pulses = std::max(pulses, pulses_in(drive.gate, time));
  out.frame.neglected *= pulses;
  return out;
}

std::vector<DrivenZone> zones_near_lines(const LevelFields& fields, const Structure& structure,
                                         double speed) {
  const CoupledSpins spins = coupled_spins(structure);
  std::vector<DrivenZone> out;
  for (const CourseSection& section : fields.sections) {
    const SpinZone& zone = section.field;
    std::vector<DriveTerm> drives(zone.drive, zone.drive + zone.drives);
    if (section.wave >= 0)
      std::ranges::copy(fields.waves[static_cast<std::size_t>(section.wave)].drives,
                        std::back_inserter(drives));
    const Vector3 uniform =
        zone.spin_rate *
        (zone.turned ? Vector3{zone.frame[6], zone.frame[7], zone.frame[8]} : Vector3{0, 0, 1});
    const std::span shaped(fields.shaped.data() + section.shaped_begin,
                           fields.shaped.data() + section.shaped_end);
    // Fields of one part that differ in their phase alone, as a formula's cosine and sine do, drive as one.
    std::vector<int> together(drives.size());
    const auto part_of = [&](std::size_t number) {
      const auto own = std::ranges::find(shaped, static_cast<int>(number), &ShapedTerm::drive);
      return own == shaped.end() ? -1 : own->part;
    };
    for (std::size_t number = 0; number < drives.size(); ++number)
      for (together[number] = 0; together[number] < static_cast<int>(number); ++together[number]) {
        const auto first = static_cast<std::size_t>(together[number]);
        DriveTerm in_phase = drives[number];
        in_phase.phase = drives[first].phase;
        if (part_of(number) >= 0 && part_of(number) == part_of(first) && in_phase == drives[first]) break;
      }
    for (int number = 0; number < static_cast<int>(drives.size()); ++number) {
      if (together[static_cast<std::size_t>(number)] != number) continue;
      const DriveTerm& drive = drives[static_cast<std::size_t>(number)];
      const auto swings = [&](const ShapedTerm& term) {
        return term.drive >= 0 && together[static_cast<std::size_t>(term.drive)] == number;
      };
      const double frequency = std::abs(drive.omega) / two_pi,
                   swept = (drive.omega < 0 ? -1 : 1) * swept_in_all(drive) / two_pi;
      const auto [first, second] = quadratures(drive);
      const double full = std::abs(drive.spin_rate);
      std::optional<DrivenZone> best;
      double nearest = std::numeric_limits<double>::infinity();
      const auto own = std::ranges::find_if(shaped, swings);
      for (int i = 0; i < (shaped.empty() ? 1 : places_of_frame); ++i) {
        const double y = place_in(zone.begin, zone.end, i);
        const Vector3 b = static_field(uniform, shaped, {}, y, y / speed).here;
        Vector3 with_cosine = full * first, with_sine = full * second;
        for (const ShapedTerm& term : shaped) {
          if (!swings(term)) continue;
          FieldHere<double> peak{};
          add_field<HostMaths>(term, 0.0, y, 0.0, peak);
          const Vector3 field{peak.field[0], peak.field[1], peak.field[2]};
          const double ahead = drives[static_cast<std::size_t>(term.drive)].phase - drive.phase;
          with_cosine = with_cosine + portable::cos(ahead) * field;
          with_sine = with_sine - portable::sin(ahead) * field;
        }
        const double size = length_of(b);
        DriveParts parts = parts_about(size > 0 ? (1 / size) * b : Vector3{0, 0, 1}, with_cosine, with_sine);
        for (double* part :
             {&parts.left, &parts.right, &parts.along})  // a quarter of a turn is not one to the bit
          if (std::abs(*part) < 1e-12 * parts.size()) *part = 0;
        const auto [distance, there] = nearest_line(spins, size, parts, frequency, swept);
        const bool as_near = best && distance == nearest;
        if (best && !(distance < nearest || (as_near && parts.size() > best->parts.size()))) continue;
        const bool is_even = drive.envelope.shape == Shape::rectangular && own == shaped.end();
        best = DrivenZone{zone.begin, zone.end, size,       there,
                          parts,      is_even,  drive.gate, own != shaped.end() ? own->part : drive.part};
        nearest = distance;
      }
      const bool vanishes_on_axis = best->parts.size() == 0 && best->part >= 0;
      if (!vanishes_on_axis) out.push_back(*best);
    }
  }
  return out;
}

}  // namespace rabiline
