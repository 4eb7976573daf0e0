#pragma once
// Fields as plain values: B(y, t) inside one section of the beam. Fields that overlap add up.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/portable_math.hpp"
#include "core/vector3.hpp"
#include "field/envelope.hpp"

namespace rabiline {

/// A field constant in space and time.
struct UniformTerm {
  Vector3 field;  // [T]
  bool operator==(const UniformTerm&) const = default;
};

/// Which way a field turns: about +z (or the axis of its own plane), or relative to the Larmor precession
/// -gamma B of a species in B along that axis.
enum class Turn { positive, negative, with_precession, against_precession };

/// The share of the highest amplitude at y [m].
inline double share_of(const Envelope& envelope, double y) {
  if (envelope.shape == Shape::half_sine)
    return y > envelope.begin && y < envelope.begin + envelope.length
               ? portable::sin(std::numbers::pi * (y - envelope.begin) / envelope.length)
               : 0;
  if (envelope.shape == Shape::gaussian) {
    const double sigmas = (y - envelope.begin - envelope.length / 2) / envelope.sigma;
    return envelope.sigma > 0 ? portable::exp(-sigmas * sigmas / 2) : 0;
  }
  if (envelope.shape == Shape::standing_wave) {
    if (!(y > envelope.begin && y < envelope.begin + envelope.length)) return 0;
    const double angle = envelope.half_waves * std::numbers::pi * (y - envelope.begin) / envelope.length;
    return envelope.is_cosine ? portable::cos(angle) : portable::sin(angle);
  }
  return 1;
}
/// What a sweep has added to the angle of a clock by the time t, in units of its rate times s^2.
inline double swept(const Sweep& sweep, double t) {
  const double all = sweep.end - sweep.begin, within = std::clamp(t - sweep.begin, 0.0, all);
  return sweep.rate * (within * within / 2 + all * std::max(0.0, t - sweep.end));
}
/// Whether a field is on at the time t.
inline bool is_on(const Gate& gate, double t) {
  if (gate.begin == gate.end) return true;
  double since = t - gate.begin;
  if (gate.period > 0)
    since -= gate.period * std::clamp(std::floor(since / gate.period), 0.0, gate.times - 1);
  return since >= 0 && since < gate.end - gate.begin;
}
/// The factor of a field's size beside its centre.
inline double share_of(const Slopes& slopes, double x, double z) {
  return 1 + slopes.size_x * (x - slopes.x) + slopes.size_z * (z - slopes.z);
}
/// What is added to its phase there.
inline double phase_of(const Slopes& slopes, double x, double z) {
  return slopes.phase_x * (x - slopes.x) + slopes.phase_z * (z - slopes.z);
}

/// The clock that fields follow: its angle is omega t + phase, t the time in the laboratory from a particle's
/// emission, or from the pulse's t = 0, on.
struct Oscillator {
  double frequency = 0;  // [Hz]
  Turn turn = Turn::positive;
  double phase = 0;           // [rad], the field's own included
  int part = 0;               // number of the part whose clock it is
  bool random_phase = false;  // the phase at emission is drawn for each particle
  int harmonic = 1;           // of the clock whose phase that is: so many times the phase that is drawn
  Sweep sweep{};
  double lag = 0;  // [rad] of what swings: that one axis of a turning field comes behind the other
  bool operator==(const Oscillator&) const = default;

  /// [rad] Of what swings by it, cos(2 pi f t + it), where first turns towards second by sense f.
  double phase_of_swing(double gyromagnetic_ratio) const { return sense(gyromagnetic_ratio) * (phase - lag); }
  /// The sense of turning about first x second of a field, +1 or -1, for a species with that gamma; a species
  /// without a moment counts as one with gamma > 0.
  double sense(double gyromagnetic_ratio) const {
    const double precession = gyromagnetic_ratio < 0 ? 1 : -1;
    switch (turn) {
      case Turn::positive:
        return 1;
      case Turn::negative:
        return -1;
      case Turn::with_precession:
        return precession;
      case Turn::against_precession:
        break;
    }
    return -precession;
  }
  /// Signed angular velocity [rad/s], where nothing sweeps it.
  double omega(double gyromagnetic_ratio) const {
    return sense(gyromagnetic_ratio) * 2 * std::numbers::pi * frequency;
  }
};

/// How a field moves: it turns in its plane, swings along the plane's first axis, or does the latter of which
/// only the half is kept that turns with the precession about the static field: the rotating-wave
/// approximation.
enum class FieldMotion { turns, swings, swings_in_rotating_wave };

/// A field in the plane of two axes at the angle omega t + twist (y - begin) + phase from the first towards
/// the second. Swinging fields have amplitude cos(angle) along the first axis.
struct RotatingTerm {
  double amplitude = 0;  // [T] where the envelope is highest
  Oscillator oscillator;
  FieldMotion motion = FieldMotion::turns;
  Vector3 first{1, 0, 0}, second{0, 1, 0};  // the plane
  double twist = 0;                         // [rad/m] along the beam, from envelope.begin
  Envelope envelope;
  Gate gate{};
  Slopes slopes{};
  int part = -1;  // of the beamline, whose field it is
  bool operator==(const RotatingTerm&) const = default;
};

}  // namespace rabiline
