#include "plan/zones.hpp"
#include "core/constants.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace rabiline {
namespace {

using constants::two_pi;

constexpr double square_to = 1e-12;  // cosine below which two axes count as square to each other

void put(const Vector3& v, double* to) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}
Vector3 vector_at(const double* v) { return {v[0], v[1], v[2]}; }

bool is_stepped(const SpinZone& zone) {
  return zone.kind == ZoneKind::general || zone.kind == ZoneKind::profiled;
}

/// A probability p of a spin I changes with the angle by 2 sqrt(p (1 - p)) times the spread of the component
/// about the axis of the turn at most, which is at most sqrt(I (I + 1)/2) in a level across it; a spin itself
/// by the angle.
double answer_per_angle(const LawTraits& traits, const Species& species) {
  const double spin = species.spin.value();
  return traits.has_levels ? std::max(1.0, std::sqrt(spin * (spin + 1) / 2)) : 1;
}

/// [rad/s] At its begin or its end.
double fastest_of(const DriveTerm& drive) {
  return std::max(std::abs(drive.omega), std::abs(drive.omega + swept_in_all(drive)));
}

/// For a field that swings with its angle.
DriveTerm drive_without_field(const Oscillator& oscillator, double gyromagnetic_ratio) {
  DriveTerm drive;
  put({}, drive.second);
  drive.omega = two_pi * oscillator.frequency;
  drive.phase = oscillator.phase_of_swing(gyromagnetic_ratio);
  drive.oscillator = oscillator.random_phase ? oscillator.part : -1;
  drive.random_turn *= oscillator.harmonic * oscillator.sense(gyromagnetic_ratio);
  drive.sweep = oscillator.sweep;
  drive.sweep.rate *= two_pi;
  return drive;
}

}  // namespace

void ZoneMaker::add_shaped_fields(const Section& section, SpinZone& zone,
                                  std::vector<ShapedTerm>& fields) const {
  fields.insert(fields.end(), section.shaped.begin(), section.shaped.end());
  const Oscillator* last = nullptr;
  for (const SwingingTerm& term : section.swinging) {
    if (last == nullptr || !(*last == term.oscillator))
      zone.drive[zone.drives++] = drive_without_field(term.oscillator, species_.gyromagnetic_ratio);
    last = &term.oscillator;
    fields.push_back(term.field);
    fields.back().drive = zone.drives - 1;
  }
}

double swept_in_all(const DriveTerm& drive) {
  return drive.sweep.rate * (drive.sweep.end - drive.sweep.begin);
}

bool is_shaped_otherwise(const DriveTerm& drive) {
  const Slopes& slopes = drive.slopes;
  return drive.sweep.rate != 0 || drive.gate.begin != drive.gate.end || slopes.phase_x != 0 ||
         slopes.phase_z != 0 || slopes.size_x != 0 || slopes.size_z != 0;
}

Turning turning_of(const Law& law, const Species& species) {
  // Lorentz: m dv/dt = q v x B, so W = -(q/m) B.
  const LawTraits traits = law_traits(law);
  const double per_angle = answer_per_angle(traits, species);
  if (traits.has_forces)  // a looser tolerance lengthens no step
    return {-species.charge / species.mass, false, std::min(traits.tolerance, usual_tolerance), per_angle};
  return {-traits.kappa * species.gyromagnetic_ratio, traits.closure == Closure::torque, traits.tolerance,
          per_angle};
}

Vector3 ZoneMaker::static_field(const Section& section) const {
  Vector3 field = section.field;
  for (const CoilTerm& coil : section.coils) field = field + coil.field(coil_species_);
  return field;
}

SpinZone ZoneMaker::zone_of(const Section& section) const {
  SpinZone zone;
  zone.begin = section.begin;
  zone.end = section.end;
  const Vector3 field = static_field(section);
  const bool along_z = field.x == 0 && field.y == 0;
  const double size = along_z ? field.z : length_of(field);
  const Vector3 axis = along_z ? Vector3{0, 0, 1} : (1 / size) * field;
  zone.spin_rate = -species_.gyromagnetic_ratio * size;
  zone.turn_rate = turning_.rate_per_tesla * size;
  assert(section.rotating.size() <= static_cast<std::size_t>(most_drives));
  for (const RotatingTerm& term : section.rotating)
    if (term.amplitude != 0) zone.drive[zone.drives++] = drive_of(term, axis, size);
  choose_frame(zone, axis, size != 0);
  if (is_stepped(zone)) zone.step = usual_step(pace_of(zone));
  return zone;
}

SpinPace ZoneMaker::pace_of(const SpinZone& zone) const {
  double rate = rate_of(zone), shortest = std::numeric_limits<double>::infinity();
  if (zone.kind == ZoneKind::profiled) {
    const DriveTerm& drive = zone.drive[0];
    const double detuned = zone.spin_rate - drive.omega - drive.twist * speed_;
    rate = std::max({std::abs(detuned), std::abs(detuned - swept_in_all(drive)), std::abs(drive.spin_rate)});
  }
  for (int i = 0; i < zone.drives; ++i) {
    const Envelope& envelope = zone.drive[i].envelope;
    if (envelope.shape == Shape::gaussian) shortest = std::min(shortest, 6 * envelope.sigma);
    if (envelope.shape == Shape::half_sine) shortest = std::min(shortest, envelope.length);
    if (envelope.shape == Shape::standing_wave)
      shortest = std::min(shortest, envelope.length / envelope.half_waves);
  }
  return {rate, shortest / speed_};
}

void ZoneMaker::keep_tolerance(SpinZone& zone) const {
  if (!is_stepped(zone)) return;
  const double allowed = turning_.path_error / turning_.answer_per_angle;
  zone.step = std::min(zone.step, step_within(pace_of(zone), zone, speed_, allowed));
}

/// A drive about the static field's axis, whose signed size along it is given [T].
DriveTerm ZoneMaker::drive_of(const RotatingTerm& term, const Vector3& axis, double static_field) const {
  DriveTerm drive;
  double amplitude = term.amplitude;
  drive.omega = term.oscillator.omega(species_.gyromagnetic_ratio);
  drive.phase = term.oscillator.phase;
  drive.oscillator = term.oscillator.random_phase ? term.oscillator.part : -1;
  drive.twist = term.twist;
  drive.envelope = term.envelope;
  drive.gate = term.gate;
  drive.slopes = term.slopes;
  drive.part = term.part;
  double sense = term.oscillator.sense(species_.gyromagnetic_ratio);
  Vector3 first = term.first, second = term.second;
  if (term.motion == FieldMotion::swings) {
    sense = 1;
    drive.omega = two_pi * term.oscillator.frequency;
    second = {};
  }
  if (term.motion == FieldMotion::swings_in_rotating_wave) {
    // A cos(angle) a = A/2 [turning with +angle] + A/2 [turning with -angle], both from a across the axis.
    const Vector3 across = first - dot(first, axis) * axis;
    const double part = length_of(across);
    sense = species_.gyromagnetic_ratio * static_field > 0 ? -1 : 1;  // of the precession -gamma B
    amplitude *= part / 2;
    first = part > square_to ? (1 / part) * across : some_normal(axis);
    second = cross(axis, first);
    drive.omega = sense * two_pi * term.oscillator.frequency;
    drive.phase *= sense;
    drive.random_turn *= sense;
    drive.twist *= sense;
    drive.slopes.phase_x *= sense;
    drive.slopes.phase_z *= sense;
  }
  drive.sweep = term.oscillator.sweep;
  drive.sweep.rate *= sense * two_pi;
  drive.spin_rate = -species_.gyromagnetic_ratio * amplitude;
  drive.turn_rate = turning_.rate_per_tesla * amplitude;
  put(first, drive.first);
  put(second, drive.second);
  drive.in_xy = first == Vector3{1, 0, 0} && second == Vector3{0, 1, 0};
  return drive;
}

/// A single field that turns square to the static one has a closed form, in a frame of these axes.
void ZoneMaker::choose_frame(SpinZone& zone, const Vector3& axis, bool is_static) const {
  put(axis, zone.frame + 6);
  zone.turned = !(axis == Vector3{0, 0, 1});
  if (zone.drives == 0) {
    const Vector3 first = zone.turned ? some_normal(axis) : Vector3{1, 0, 0};
    put(first, zone.frame);
    put(zone.turned ? cross(axis, first) : Vector3{0, 1, 0}, zone.frame + 3);
    return;
  }
  DriveTerm& drive = zone.drive[0];
  const Vector3 first = vector_at(drive.first), second = vector_at(drive.second),
                normal = cross(first, second);
  const bool turns = length_of(normal) > 0.5;
  const double cosine = dot(normal, axis);
  if (zone.drives > 1 || !turns || (is_static && std::abs(cosine) < 1 - square_to)) {
    zone.kind = ZoneKind::general;
    return;
  }
  zone.kind = drive.envelope.shape == Shape::rectangular && !is_shaped_otherwise(drive) ? ZoneKind::rotating
                                                                                        : ZoneKind::profiled;
  if (drive.in_xy && !zone.turned) return;
  // The frame's third axis is the plane's normal; a field against it turns every rate about it round.
  if (cosine < 0 && is_static) {
    zone.spin_rate = -zone.spin_rate;
    zone.turn_rate = -zone.turn_rate;
  }
  put(first, zone.frame);
  put(second, zone.frame + 3);
  put(normal, zone.frame + 6);
  zone.turned = true;
}

double ZoneMaker::rate_of(const SpinZone& zone) const {
  double spin = std::abs(zone.spin_rate), turn = std::abs(zone.turn_rate), fastest = 0;
  for (int i = 0; i < zone.drives; ++i) {
    const DriveTerm& drive = zone.drive[i];
    spin += std::abs(drive.spin_rate);
    turn += std::abs(drive.turn_rate);
    fastest = std::max(fastest, fastest_of(drive) + std::abs(drive.twist) * speed_);
  }
  return std::max({spin, turn, fastest});
}

double ZoneMaker::phase_behind(const SpinZone& zone) const {
  double drive = 0;  // only what moves by itself knows the time of emission
  for (int i = 0; i < zone.drives; ++i) drive = std::max(drive, fastest_of(zone.drive[i]));
  return rate_of(zone) * zone.end / speed_ + drive * latest_start_;
}

ZoneMaker zone_maker(const Beamline& beamline, const Species& species) {
  return {species, beamline.species.front().species, turning_of(beamline.law, species),
          mean_speed(beamline.source.speed, species.mass), latest_start(beamline.source.pulse)};
}

bool moves_spin_along_z(const SpinZone& zone) {
  return zone.drives > 0 || (zone.spin_rate != 0 && zone.turned);
}

}  // namespace rabiline
