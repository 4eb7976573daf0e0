#pragma once
// Touching fields that are flown through in steps, since they turn the velocity or differ from place to
// place, as the kernel sees them.
#include "field/shaped_term.hpp"
#include "transport/kernels.hpp"
#include "transport/moment_law.hpp"
#include "transport/stages/alignment.hpp"

namespace rabiline {

enum class EdgeKind { open, plate, screen, align };
/// A plane inside a region, between two zones.
struct RegionEdge {
  EdgeKind kind = EdgeKind::open;
  Aperture plate;
  Screen screen;
  Alignment align;
  int part = 0;
  bool operator==(const RegionEdge&) const = default;
};
/// How particles are flown through a zone of a region.
enum class ZoneCourse {
  steps,         // short ones that follow every turn of spin and velocity: any fields
  constant,      // W is constant in a frame that turns at a constant rate: closed form
  joint_turns,   // kappa = 1: the velocity in closed form, the place by quadrature over less than a turn
  slow_turns,    // kappa = 1, spins near the field: over many turns, what varies slowly by quadrature
  through_field  // any field at all: each particle in steps of its own length
};
inline constexpr int span_points = 6;  // of Gauss and Legendre
/// Constants of a course that goes from span to span, at the Gauss points of each and, last, at its end.
struct SpanTable {
  double span = 0;                       // [s]
  double time[span_points + 1] = {};     // [s] from its begin
  double turn[span_points + 1][9] = {};  // the spin's turning, row by row, in the frame of the rotating field
  double phase[span_points + 1][3] = {};  // [rad] times S at the begin: the velocity's turning about S
  // [rad] of the field's turning; between the ends of a slow course less that of the precession.
  double cosine[span_points + 1] = {}, sine[span_points + 1] = {};
  double tip = 0;  // by how much the sine of the angle between spin and field may grow
  double bend = 0,
         drive_bend = 0;  // [rad/s] the turning of the velocity by the static and the rotating field
  bool operator==(const SpanTable&) const = default;
};
/// The free space between a magnet's poles, in a frame turned about the beam.
struct RegionGap {
  MagnetWalls walls;
  double x = 0, z = 0, height = 0;  // [m] (x, z) of the laboratory is (0, height) of the frame
  double cosine = 1, sine = 0;
  int part = 0;  // the magnet
  bool operator==(const RegionGap&) const = default;
};
/// A straight channel with a rectangular opening, which stops what touches its walls.
struct RegionChannel {
  double x = 0, z = 0, half_x = 0, half_z = 0;  // [m] its centre and halves
  double cosine = 1, sine = 0;                  // of its turn about the beam, from +z towards +x
  int part = 0;                                 // whose it is
  bool operator==(const RegionChannel&) const = default;
};
/// One zone of a region with its walls and course.
struct RegionZone {
  SpinZone field;
  double wall_radius = 0;         // [m]
  double wall_x = 0, wall_z = 0;  // [m] its centre
  int wall_part = 0;
  double step = 0;        // [s] and, on any course, how finely walls are looked at where they are near
  int sights_passed = 0;  // of the region, up to its end
  double detour = 1;      // how many times longer than straight flight particles stay, about: for the cost
  ZoneCourse course = ZoneCourse::steps;
  SpanTable table;
  int shaped_begin = 0, shaped_end = 0;  // of the region's fields that differ from place to place
  int electric_end = 0;                  // of its electric ones, which begin at shaped_end
  int gap_begin = 0, gap_end = 0;        // of the gaps of magnets
  int channel_begin = 0, channel_end = 0;
  double uniform[3] = {};  // [T] the sum of all static fields that do not
  double longest = 0;      // [m] way in one step through a field
  bool operator==(const RegionZone&) const = default;
};
/// How one species feels an electric field E, to first order in v/c. Its spin sees the motional field
/// -v x E/c^2 besides B (J. D. Jackson, Classical Electrodynamics, 3rd ed., 11.10: B' = B - v x E/c^2 in the
/// frame of the particle), so that it turns with -gamma B'; the axes of a charge that E accelerates turn in
/// the laboratory with -v x a/(2 c^2), a = q E/m (Thomas; 11.8 there). H = -d sigma.E turns it with -d/(I
/// hbar) E.
struct ElectricCoupling {
  double spin_per_motional = 0;  // [rad/(s T)] -gamma + q/(2 m), of -v x E/c^2
  double spin_per_electric = 0;  // [rad/s per V/m] -d/(I hbar)
  double turn_share = 0;         // of that turning, by which the velocity turns jointly
  double acceleration = 0;       // [m/s^2 per V/m] q/m
  bool operator==(const ElectricCoupling&) const = default;
};
/// How one species feels fields that differ from place to place, and what else accelerates it.
struct FieldCoupling {
  double spin_per_tesla = 0;  // [rad/(s T)] -gamma
  double turn_per_tesla = 0;  // [rad/(s T)] of the velocity
  double pull = 0;            // [m/s^2 per T/m] the whole moment over the mass; 0: no force by a gradient
  int levels = 0;             // quantum: the moment is (m/I) along the image of z; 0: it is along S
  bool follows_level =
      false;               // the particle stays in its level along the field, and the force is mu grad |B|
  MomentLaw moments{};     // of that level where it depends on |B| [J/T]
  double mass = 1;         // [kg]
  double gravity[3] = {};  // [m/s^2]
  ElectricCoupling electric{};
  bool watches_turning = false;  // how fast the static field turns, for tallies
  double tolerance = 1e-6;       // of spin, direction, and place over the length of a zone
  bool operator==(const FieldCoupling&) const = default;
};
/// What becomes of a species' levels where a field differs from place to place, reckoned on the axis and
/// beside it at the mean speed: their paths come apart, and their phases spread over the beam.
struct StretchOutlook {
  double splitting = 0;  // [m] of the outermost paths, at the last detector
  double feature = 0;    // [m] the smallest slit or bin behind it, or spot of the beam
  double turns = 0;      // by which the phase between the outermost levels differs over the beam
  bool sorts = false;    // each particle is found in one level
  bool between = false;  // neither one path nor no phase: the law's `outcomes` decided
  bool operator==(const StretchOutlook&) const = default;
};
/// What needs more of them through one zone gives up.
inline constexpr double most_field_steps = 1e6;

/// Seconds that one particle takes through a zone with any course but `through_field`, on one core.
double cost_of(const RegionZone&, double speed);

/// Touching fields that turn the velocity: dv/dt = W x v, W = turn - (turn . S) S where `along_spin` is taken
/// off.
struct Region {
  RandomKey key;
  const RegionZone* zones = nullptr;
  const RegionEdge* edges = nullptr;  // edges[i] is crossed between zones i and i+1; zone_count - 1 of them
  int zone_count = 0;
  int channel_count = 0;
  bool take_off_spin_component = false;  // closure torque
  const ShapedTerm* shaped = nullptr;
  const RegionGap* gaps = nullptr;
  const RegionChannel* channels = nullptr;
  FieldCoupling feels;
  double most_way = 0;            // [m] flown in one zone at one visit; what goes on for longer gives up
  std::uint64_t most_visits = 0;  // of zones
  // Planes that are looked at, ascending. Nothing happens there: steps go on across them. `seen` takes for
  // each of them, where it is crossed forward for the first time, a particle's state in its own row.
  BatchView* seen = nullptr;
  int sight_count = 0;
};
/// How a particle's flight through a region ended, in the batch's scratch column: an end, or base + edge or
/// wall. Walls are numbered: the round ones by their zones, then the channels, then the gaps.
namespace region_end {
inline constexpr std::uint64_t forward = 0, backwards = 1, gave_up = 2, left_map = 3;
inline constexpr std::uint64_t at_wall = 16, stopped_at_edge = 1 << 16, caught_at_edge = 1 << 17;
}  // namespace region_end

RABILINE_KERNEL(turn, void(const Region&, BatchView&, const StepRecorder*))

}  // namespace rabiline
