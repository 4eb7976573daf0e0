#pragma once
// Zones along the beam and the fields that drive transitions between levels in them.
#include <optional>

#include "field/terms.hpp"

namespace rabiline {

/// +1 and -1 of a field that turns in the xy plane, right-handed about +z (from +x towards +y) or
/// left-handed; 0 of one that swings along its first axis, of which the rotating-wave approximation keeps a
/// half.
inline int sense_of(const RotatingTerm& drive) {
  if (drive.motion != FieldMotion::turns) return 0;
  return drive.oscillator.turn == Turn::negative ? -1 : 1;
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
