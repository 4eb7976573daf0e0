#pragma once
// The beam cut at every edge of a field: what acts in each stretch, and the planes across the beam.
#include <cassert>
#include <limits>
#include <memory>
#include <variant>
#include <vector>

#include "field/magnet_shape.hpp"
#include "field/shaped_term.hpp"
#include "field/terms.hpp"
#include "particle/opening.hpp"
#include "particle/species.hpp"
#include "particle/speed.hpp"
#include "spin/level_names.hpp"
#include "tally/tally.hpp"

namespace rabiline {

/// Numbers a part: its index in the beamline's list. The chamber counts as a part of its own.
inline constexpr int chamber_number = -1;

/// A round wall along the beam.
struct Wall {
  double radius = std::numeric_limits<double>::infinity();  // [m]
  int part = chamber_number;                                // whose wall it is
  Offset offset{};                                          // of its centre from the axis
  bool operator==(const Wall&) const = default;
};

/// A field that turns the spins of the beam's first species by an angle at one speed: its size follows from
/// gamma.
struct CoilTerm {
  Vector3 axis{0, 0, 1};
  double angle = 0;   // [rad] right-handed about the axis
  double length = 0;  // [m]
  SpeedQuantity speed;
  bool operator==(const CoilTerm&) const = default;
  /// [T] for that species, whose spins turn with -gamma B.
  Vector3 field(const Species& species) const {
    if (angle == 0) return {};
    assert(species.gyromagnetic_ratio != 0);
    const double rate = angle * speed_of(speed, species.mass) / length;
    return (-rate / species.gyromagnetic_ratio) * axis;
  }
};

/// A field that swings in time with cos(omega t + phase), and differs from place to place.
struct SwingingTerm {
  ShapedTerm field;  // at its peak
  Oscillator oscillator;
  bool operator==(const SwingingTerm&) const = default;
};
/// The free space in a deflecting magnet that is flown through as one field among others.
struct GapTerm {
  MagnetWalls walls;
  Offset offset;      // of the point (0, height) in the walls' frame
  Roll tilt;          // of that frame, about that point
  double height = 0;  // [m]
  int part = 0;
  bool operator==(const GapTerm&) const = default;
};

/// A stretch of the beam with all the fields that overlap there.
struct Section {
  double begin = 0, end = 0;  // [m]
  Vector3 field;              // [T] sum of the uniform fields
  std::vector<RotatingTerm> rotating;
  std::vector<CoilTerm> coils;
  std::vector<ShapedTerm> shaped;  // that differ from place to place
  std::vector<SwingingTerm> swinging;
  std::vector<ShapedTerm> electric;  // E, in V/m and V/m^2
  std::vector<GapTerm> gaps;
  Wall wall;                 // the narrowest
  bool falls_along = false;  // gravity acts along the beam
  bool operator==(const Section&) const = default;
  bool has_shaped_fields() const { return !shaped.empty() || !swinging.empty(); }
  /// Its flight has no closed form here: B differs from place to place, E makes what a spin sees follow its
  /// velocity, or the speed along the beam changes.
  bool needs_steps() const { return has_shaped_fields() || !electric.empty() || falls_along; }
};

/// What misses the opening stops; of a beam stop, what hits the shape.
struct PlateTerm {
  Opening opening;
  Offset offset;
  Roll tilt{};
  bool stops_inside = false;
  double length = 0;  // [m] of the channel that ends here
  bool operator==(const PlateTerm&) const = default;
};
/// Moments are aligned with a field: S gets a definite sign along it with the given probability.
struct AlignTerm {
  double probability = 1;  // that the moment comes out along the field
  double field_sign = 1;   // of B' along the axis
  Vector3 axis{0, 0, 1};
  bool operator==(const AlignTerm&) const = default;
};
/// Spins along the axis pass with one probability, spins against it with another one; or so do levels that
/// are named, and the others.
struct FilterTerm {
  Vector3 axis{0, 0, 1};
  double up = 1, down = 0;  // transmissions of the spin S along and against the axis
  std::vector<LevelName> levels{};
  bool operator==(const FilterTerm&) const = default;
};
/// A term from place to place along the beam, [m].
struct PlacedTerm {
  double begin = 0, end = 0;
  ShapedTerm term;
  bool operator==(const PlacedTerm&) const = default;
};
/// A deflecting magnet begins, and reaches to the place `end`. One with a fringe is always a field among
/// others.
struct MagnetTerm {
  double end = 0;  // [m]
  MagnetShape shape{};
  MagnetWalls walls{};
  Offset offset{};                    // of the magnet's frame: of the point (0, shape.height) in it
  Roll tilt{};                        // of the magnet's frame, about that point
  std::vector<PlacedTerm> fringed{};  // its whole field, where it has a fringe
  bool operator==(const MagnetTerm&) const = default;
};
/// What hits the screen is caught and histogrammed.
struct ScreenTerm {
  Face face;
  Offset offset;
  int bins_x = 1, bins_z = 1;
  Roll tilt{};
  double efficiency = 1;
  std::optional<PlateTerm> dead{};  // an opening inside which nothing is counted
  std::vector<Tally> tallies{};
  bool operator==(const ScreenTerm&) const = default;
};
/// What passes the face is counted and flies on.
struct MonitorTerm {
  Opening face;
  Offset offset;
  Roll tilt{};
  std::vector<Tally> tallies{};
  int plane = 0;  // its number in the monitor
  bool operator==(const MonitorTerm&) const = default;
};

/// The part itself is the stage that stands there (stage_of, beside the stage).
struct OwnStageTerm {
  bool operator==(const OwnStageTerm&) const = default;
};

struct Plane {
  double y = 0;  // [m]
  int part = 0;
  std::variant<PlateTerm, AlignTerm, FilterTerm, MagnetTerm, ScreenTerm, MonitorTerm, OwnStageTerm> term;
  bool operator==(const Plane&) const = default;
};

/// The whole beam: sections where a field or a wall is, ascending and not overlapping, and planes, ascending.
struct Sections {
  std::vector<Section> sections;
  std::vector<Plane> planes;
  std::vector<std::shared_ptr<const void>> tables{};  // keeps alive what terms point into
};

}  // namespace rabiline
