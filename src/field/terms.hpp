#pragma once
// Fields as plain values: B(y, t) inside one section of the beam. Fields that overlap add up.
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
  return 1;
}

/// The clock that fields follow: its angle is omega t + phase, t the time in the laboratory from a particle's
/// emission, or from the pulse's t = 0, on.
struct Oscillator {
  double frequency = 0;  // [Hz]
  Turn turn = Turn::positive;
  double phase = 0;           // [rad], the field's own included
  int part = 0;               // number of the part whose clock it is
  bool random_phase = false;  // the phase at emission is drawn for each particle
  bool operator==(const Oscillator&) const = default;

  /// Signed angular velocity [rad/s] about first x second of a field, for a species with that gamma; a
  /// species without a moment counts as one with gamma > 0.
  double omega(double gyromagnetic_ratio) const {
    constexpr double two_pi = 6.283185307179586476925;
    const double precession = gyromagnetic_ratio < 0 ? 1 : -1;
    switch (turn) {
      case Turn::positive:
        return two_pi * frequency;
      case Turn::negative:
        return -two_pi * frequency;
      case Turn::with_precession:
        return precession * two_pi * frequency;
      case Turn::against_precession:
        break;
    }
    return -precession * two_pi * frequency;
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
  bool operator==(const RotatingTerm&) const = default;
};

}  // namespace rabiline
