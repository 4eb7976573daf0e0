#pragma once
// Zones along the beam and the fields that drive transitions between levels in them.
#include <optional>

#include "core/portable_math.hpp"
#include "field/terms.hpp"

namespace rabiline {

/// +1 and -1 of a field that turns in the xy plane, right-handed about +z (from +x towards +y) or
/// left-handed; 0 of one that swings along its first axis, of which the rotating-wave approximation keeps a
/// half.
inline int sense_of(const RotatingTerm& drive) {
  if (drive.motion != FieldMotion::turns) return 0;
  return drive.oscillator.turn == Turn::negative ? -1 : 1;
}

/// The sizes [T] of what turns right-handed and left-handed about +z and of what swings along it: a photon of
/// the first is taken up with m + 1, of the second with m - 1, of the third with m as it is.
struct DriveParts {
  double right = 0, left = 0, along = 0;
  bool in_phase = true;  // all of it swings along one direction, or turns
  /// +1 and -1 of what turns in one sense alone, 0 of all else.
  int sense() const {
    return along != 0 || (right != 0 && left != 0) ? 0 : right != 0 ? 1 : left != 0 ? -1 : 0;
  }
  /// [T] The largest that it gets, about.
  double size() const { return portable::hypot(right + left, along); }
  bool operator==(const DriveParts&) const = default;
};
inline DriveParts parts_of(const RotatingTerm& drive) {
  const int sense = sense_of(drive);
  if (sense != 0) return {sense > 0 ? drive.amplitude : 0, sense < 0 ? drive.amplitude : 0, 0};
  const double across = drive.amplitude * portable::hypot(drive.first.x, drive.first.y);
  return {across / 2, across / 2, drive.amplitude * drive.first.z};
}

/// Where the static field along the z axis is uniform; levels are those along +z. What drives them turns in
/// the xy plane with a given sense, or swings in the rotating-wave approximation; it does not twist. Fields
/// of one part's clock have one frequency.
struct LevelZone {
  double begin = 0, end = 0;  // [m]
  double field = 0;           // [T] against +z where negative
  std::optional<RotatingTerm> drive{};
  int part = -1;  // of the beamline, whose field drives
  bool operator==(const LevelZone&) const = default;
};

}  // namespace rabiline
