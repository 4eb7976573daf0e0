#pragma once
// Fields as plain values: B(t) inside one section of the beam. Fields that overlap add up.
#include <string>

namespace rabiline {

/// A field B_z [T], constant in space and time.
struct UniformTerm {
  double field = 0;  // [T] along +z
  bool operator==(const UniformTerm&) const = default;
};

/// Which way a field turns: about +z, or relative to the Larmor precession -gamma B of a species in B along
/// +z.
enum class Turn { positive, negative, with_precession, against_precession };

/// A field of constant size in the xy plane at the angle omega t + phase from +x, t since the particle's
/// emission.
struct RotatingTerm {
  double amplitude = 0;  // [T]
  double frequency = 0;  // [Hz], not negative
  Turn turn = Turn::positive;
  double phase = 0;           // [rad], added to the oscillator's own
  int oscillator = 0;         // part number of the part whose clock this field follows
  bool random_phase = false;  // the oscillator's phase at emission is drawn for each particle
  bool operator==(const RotatingTerm&) const = default;

  /// Signed angular velocity [rad/s] about +z for a species with that gamma; a species without a moment
  /// counts as one with gamma > 0.
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
