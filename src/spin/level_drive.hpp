#pragma once
// Zones along the beam and the fields that drive transitions between levels in them.
#include <optional>

namespace rabiline {

/// A field that turns in the xy plane, right-handed about +z (from +x towards +y) or left-handed, or one that
/// swings along an axis: A (cos p, +-sin p, 0) or A u cos p, with the angle p = 2 pi f t + phase.
enum class DriveKind { rotating_positive, rotating_negative, oscillating };

/// How the amplitude runs along the whole field: 1, sin(pi (y - begin) / length), or
/// exp(-((y - middle) / sigma)^2 / 2).
enum class Envelope { rectangular, half_sine, gaussian };

/// All fields of one clock have one frequency; its angle is 2 pi f t, t from the particle's emission at y =
/// 0, and with `random_phase` any angle at that time, for each particle anew.
struct LevelDrive {
  DriveKind kind = DriveKind::rotating_positive;
  double amplitude = 0;             // [T] A
  double frequency = 0;             // [Hz] f
  double direction[3] = {0, 0, 1};  // u of length 1, of an oscillating field
  double phase = 0;                 // [rad]
  int clock = 0;
  bool random_phase = false;
  Envelope envelope = Envelope::rectangular;
  double begin = 0, length = 0;  // [m] of the whole field, for the envelope; its middle is begin + length/2
  double sigma = 0;              // [m] of a Gaussian

  /// The share of the amplitude at y [m].
  double share(double y) const;
  bool operator==(const LevelDrive&) const = default;
};

/// Where the static field along +z is uniform.
struct LevelZone {
  double begin = 0, end = 0;  // [m]
  double field = 0;           // [T] B >= 0
  std::optional<LevelDrive> drive{};
  bool operator==(const LevelZone&) const = default;
};

}  // namespace rabiline
