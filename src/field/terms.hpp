#pragma once
// Fields as plain values: B(y, t) inside one section of the beam. Fields that overlap add up.
#include <string>

#include "field/shape.hpp"
#include "core/vector3.hpp"

namespace rabiline {

/// A field constant in space and time.
struct UniformTerm {
  Vector3 field;  // [T]
  bool operator==(const UniformTerm&) const = default;
};

/// Which way a field turns: about +z (or the axis of its own plane), or relative to the Larmor precession
/// -gamma B of a species in B along that axis.
enum class Turn { positive, negative, with_precession, against_precession };

/// The size of a field along the beam, as a part of its highest.
struct Profile {
  Shape shape = Shape::rectangular;
  double begin = 0, length = 0;  // [m] along the beam
  double sigma = 0;              // [m] of a gaussian about the middle
  bool operator==(const Profile&) const = default;
};

/// How a field moves: it turns in its plane, swings along the plane's first axis, or does the latter of which
/// only the half is kept that turns with the precession about the static field: the rotating-wave
/// approximation.
enum class FieldMotion { turns, swings, swings_in_rotating_wave };

/// A field in the plane of two axes at the angle omega t + twist (y - begin) + phase from the first towards
/// the second, t the time in the laboratory. Swinging fields have amplitude cos(angle) along the first axis.
struct RotatingTerm {
  double amplitude = 0;  // [T] where the profile is highest
  double frequency = 0;  // [Hz], not negative
  Turn turn = Turn::positive;
  double phase = 0;           // [rad], added to the oscillator's own
  int oscillator = 0;         // part number of the part whose clock this field follows
  bool random_phase = false;  // the oscillator's phase at emission is drawn for each particle
  FieldMotion motion = FieldMotion::turns;
  Vector3 first{1, 0, 0}, second{0, 1, 0};  // the plane
  double twist = 0;                         // [rad/m] along the beam, from profile.begin
  Profile profile;
  bool operator==(const RotatingTerm&) const = default;

  /// Signed angular velocity [rad/s] about first x second for a species with that gamma; a species without a
  /// moment counts as one with gamma > 0.
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

}  // namespace rabiline
