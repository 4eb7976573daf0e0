#include "plan/level_exchange.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/portable_math.hpp"
#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "plan/beam.hpp"
#include "plan/geometry.hpp"
#include "plan/level_waves.hpp"
#include "plan/level_ways.hpp"

namespace rabiline {
namespace {

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

}  // namespace

double far_apart(const Species& species, const LevelFields& fields, double speed, double turned,
                 const Source& source) {
  constexpr int places = 256;
  double courses = 0, driving = 0, switching = turned, frequency = 0;  // [T/s], [T/s], [T], [Hz]
  Roughness roughness;
  double end_before = -1;
  for (const CourseSection& section : fields.sections) {
    double drives = 0, jumps = 0, swings = 0, leaps = 0;
    // Of what has a period all levels are worked out together.
    for (int i = 0; i < section.field.drives && section.period < 0; ++i) {
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

}  // namespace rabiline
