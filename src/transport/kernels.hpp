#pragma once
// The loops over particles, compiled once for each instruction set, and the plain values they work on.
// Every kernel gives the same bits on every instruction set.
#include <cstdint>

#include "core/isa.hpp"
#include "field/envelope.hpp"
#include "field/magnet_shape.hpp"
#include "particle/batch.hpp"
#include "particle/draw.hpp"
#include "tally/quantity.hpp"

namespace rabiline {

/// What a random number is drawn for: part of the counter, so that no two uses share numbers.
namespace purpose {
inline constexpr unsigned speed = 1, place = 2, direction = 3, spin = 4, align = 5, oscillator = 6;
inline constexpr unsigned emission_time = 16, collapse = 17;
}  // namespace purpose

/// Key and stream of all random numbers of a plan.
struct RandomKey {
  std::uint64_t seed = 0;
  std::uint32_t stream = 0;  // 0 where scan points share particles, else 1 + scan point
  bool operator==(const RandomKey&) const = default;
};

/// An opening in a plane, as a kernel sees it.
struct Aperture {
  double y = 0;                   // [m]
  double x0 = 0, z0 = 0;          // [m] centre
  double half_x = 0, half_z = 0;  // [m] of a rectangle
  double radius = -1;             // [m] of a disc or ring; negative: a rectangle
  double inner = 0;               // [m] where a ring begins
  double cosine = 1, sine = 0;    // of the turn about the beam, from +z towards +x
  bool stops_inside = false;      // a beam stop
  bool operator==(const Aperture&) const = default;
};

inline constexpr int most_levels = 40;

enum class SpinKind { unpolarised, levels, along_axis };
/// The spin that particles start with.
struct SpinDraw {
  SpinKind kind = SpinKind::unpolarised;
  int levels = 0;              // quantum: how many levels, uniformly populated; 0: a random direction of S
  double axis[3] = {0, 0, 1};  // of what is not unpolarised
  int steps = 0;               // levels to choose from
  double cumulative[most_levels] = {};  // the last is 1
  double along[most_levels] = {};       // S . axis of each (vector laws)
  bool operator==(const SpinDraw&) const = default;
};

/// How a batch begins.
struct Emission {
  RandomKey key;
  SpeedDraw speed{};
  Aperture opening;  // at y = 0
  bool gaussian_spot = false;
  double spot_x = 0, spot_z = 0;  // [m] sigma about the opening's centre
  DirectionDraw direction{};
  Aperture target;  // (aimed)
  bool tilted = false;
  double tilt_cos_x = 1, tilt_sin_x = 0, tilt_cos_z = 1, tilt_sin_z = 0;  // first about x, then about z
  SpinDraw spin{};
  PulseDraw pulse{};
  bool operator==(const Emission&) const = default;
};

/// A screen: which particles it catches and into which bin, ix * bins_z + iz. Bins lie along its own axes.
struct Screen {
  double y = 0, x0 = 0, z0 = 0;           // [m] centre
  double half_x = 0, half_z = 0;          // [m]
  double low_x = 0, low_z = 0;            // [m] where the histogram begins
  double bins_per_x = 0, bins_per_z = 0;  // [1/m]
  int bins_x = 1, bins_z = 1;
  int part = 0;
  double radius = -1;           // [m] of a disc; negative: a rectangle
  double cosine = 1, sine = 0;  // of its turn about the beam
  double efficiency = 1;        // share of a weight that is counted
  bool has_dead_area = false;
  Aperture dead;  // inside which nothing is counted
  bool operator==(const Screen&) const = default;
};
/// What a screen took from a batch [quanta].
struct Caught {
  std::uint64_t counted = 0, lost = 0;
};

struct Alignment {
  double probability = 1;      // that S comes out along `spin_sign` times the axis
  double spin_sign = 1;        // +1 or -1: S along the axis that puts the moment along the field
  double axis[3] = {0, 0, 1};  // unit vector
  int levels = 0;              // quantum: how many levels; 0: a vector law
  int part = 0;
  bool operator==(const Alignment&) const = default;
};

/// Spins S along the axis pass with one probability, spins against it with another one.
struct Filter {
  double axis[3] = {0, 0, 1};
  double up = 1, down = 0;
  bool quantum = false;  // the state is the level's, along the spin's image: spin 1/2
  int part = 0;
  bool operator==(const Filter&) const = default;
};

/// A constant force on the moment's part along z, from one plane to another.
struct Deflection {
  double begin = 0, end = 0;        // [m]
  double acceleration = 0;          // [m/s^2] of a moment that points along +z in full, in units of spin
  double along_x = 0, along_z = 1;  // its direction
  int levels = 0;                   // quantum: how many levels; 0: a vector law
  bool has_gap = false;
  double x0 = 0, z0 = 0, half_x = 0, half_z = 0;  // [m] free between the walls
  int part = 0;
  bool operator==(const Deflection&) const = default;
};

/// Moments of levels against the size of the field, as MomentTable has them (spin/moment_table.hpp). Compared
/// by address: a plan makes each table once.
struct MomentLaw {
  const double* coefficients = nullptr;  // [level][cell][power] J/T; null: one constant moment
  int cells = 1;
  double scale = 1;  // [T]
  bool operator==(const MomentLaw&) const = default;
};
/// A force mu(|B|) grad |B| across the beam, from one plane to another. A level, or S_z, is that along the
/// field wherever it points: the spin follows it (adiabatically), also where the field is not along z.
struct Steering {
  double begin = 0, end = 0;  // [m]
  MagnetShape shape;
  MagnetWalls walls;
  double x0 = 0, z0 = 0;        // [m] of the point (0, shape.height) of the magnet's frame
  double cosine = 1, sine = 0;  // of the frame's turn about the beam, from +z towards +x
  double mass = 1;              // [kg]
  double moment = 0;            // [J/T] the largest; signed, that of m = I or S along the field, if constant
  int levels = 0;               // quantum: how many levels; 0: a vector law
  MomentLaw moments;
  int part = 0;
  bool operator==(const Steering&) const = default;
};
/// Its path takes VEFRL steps, symplectic and of fourth order (I. Omelyan, I. Mryglod, R. Folk, Comput. Phys.
/// Commun. 146, 188 (2002)), of h = step_angle/w at most, w^2 = |mu|/m (bend + d^2) + v^2 (sharpness + e^2):
/// bend and sharpness of FieldSize, v the speed across the beam; of moments that depend on the field, d^2 =
/// |grad B|^2/(B + scale), e = |grad B|/(B + scale) and |mu| the largest, else d = e = 0. What is left of the
/// magnet is shared out in equal steps. For particles a few mm from the beam the exit was then measured to be
/// off by less than 1e-9 m + 1e-6 of the deflection (tests/unit/transport/steering_test.cpp). No flight takes
/// more than most_steps, so that close to the axis of a quadrupole, where the force jumps, a step may be too
/// long.
/// Walls are asked about at the begin and behind every step: between them a path may cut a convex wall by
/// (v h)^2/8R, less than step_angle^2/8 of its radius R.
namespace steering {
inline constexpr double step_angle = 0.06, most_steps = 4096;
}  // namespace steering

/// A field that turns or swings, as one species sees it: size cos(angle) first + size sin(angle) second,
/// angle = omega t + twist (y - envelope.begin) + phase.
struct DriveTerm {
  double spin_rate = 0;                    // [rad/s] -gamma H0: turns the spin
  double turn_rate = 0;                    // [rad/s] turns the velocity, strength included
  double omega = 0;                        // [rad/s] signed, from the first axis towards the second
  double phase = 0;                        // [rad] at emission
  int oscillator = -1;                     // part number that a random phase is drawn for; -1: none is drawn
  double random_turn = 6.283185307179586;  // [rad] that a random number in (0, 1) adds, times it
  double twist = 0;                        // [rad/m]
  Envelope envelope{};                     // of the whole field, not only of this zone
  bool in_xy = true;                       // first and second are x and y
  double first[3] = {1, 0, 0}, second[3] = {0, 1, 0};  // in the laboratory
  bool operator==(const DriveTerm&) const = default;
};
inline constexpr int most_drives = 8;  // rotating fields that may overlap at one place

/// How spins are carried through a zone.
enum class ZoneKind {
  precession,  // one turn about the static field
  rotating,    // one field turns across the static one: closed form in the frame that turns with it
  profiled,    // the same with a size that runs along the beam: steps in that frame
  general      // steps in the laboratory
};
/// The fields of one section as one species sees them. w = -gamma B turns the spin (dS/dt = w x S).
struct SpinZone {
  double begin = 0, end = 0;  // [m]
  double spin_rate = 0;       // [rad/s] of the static field, about the third axis of the frame
  double turn_rate = 0;       // [rad/s] the velocity's turning about it, strength included
  ZoneKind kind = ZoneKind::precession;
  bool turned = false;                            // the frame is not that of the laboratory
  double frame[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  // its axes, one after the other; the drive's plane first
  int drives = 0;
  DriveTerm drive[most_drives];
  double step = 0;  // [s] at most, of what is carried by steps
  bool operator==(const SpinZone&) const = default;
};

/// Where spins end: zones flown straight since the last projection, then the levels at a detector. Reads
/// only.
struct Projection {
  RandomKey key;
  int part = 0;  // the detector
  int levels = 2;
  bool majorana = false;    // quantum: S is the image of z, levels follow from the flip probability
  bool from_level = false;  // quantum, S untouched so far: one zone has a closed form
  const SpinZone* zones = nullptr;
  int zone_count = 0;
  const double* polynomials = nullptr;  // MajoranaTable::coefficients
};
/// Sums over the particles that the detector caught: of q and of q^2 = high 2^40 + low. One more than levels:
/// of all of them.
struct LevelSums {
  std::uint64_t q[most_levels + 1] = {};
  std::uint64_t squares_high[most_levels + 1] = {};
  std::int64_t squares_low[most_levels + 1] = {};
  /// Of q times the particle's whole weight, for more than two levels; of two it follows from the squares.
  std::uint64_t products_high[most_levels] = {};
  std::int64_t products_low[most_levels] = {};
};

/// What is asked about each particle where it meets a plane.
struct Gauge {
  Quantity quantity = Quantity::x;
  double y = 0;     // [m] the plane
  double mass = 0;  // [kg]
  RandomKey key{};
  PulseDraw pulse{};
};
/// What measuring the spin along an axis gives where particles meet a plane; or an angle of a spin that is a
/// vector.
struct SpinGauge {
  RandomKey key;
  Quantity quantity = Quantity::spin;
  double axis[3] = {0, 0, 1};
  int levels = 0;  // quantum: how many outcomes; 0: a vector law, whose spin has a projection
  const SpinZone* zones = nullptr;  // flown straight since the last projection
  int zone_count = 0;
  const double* polynomials = nullptr;  // MajoranaTable::coefficients
};

/// P(from -> to) between the levels of an atom on a stretch of the beam, as TransitionTable has them: at
/// slownesses of equal distance, cubic between them, and beyond the ends as at the ends.
struct Transitions {
  const float* values =
      nullptr;  // [point][row]; null: the levels are not those of an atom, or nothing drives them
  const int* begin = nullptr;  // [levels + 1] where the targets of each level begin in a row
  const int* targets = nullptr;
  double first = 0;                // [s/m]
  double points_per_slowness = 0;  // [m/s]
  int points = 1;                  // 1, or at least 4
  int row = 0;
};

/// In which level along the field a state is found, after a straight flight through the zones: the image of z
/// tells of a point moment, the transitions of an atom.
struct LevelQuestion {
  RandomKey key;
  int levels = 2;
  bool from_level = false;  // S untouched so far: one zone has a closed form
  const SpinZone* zones = nullptr;
  int zone_count = 0;
  const double* polynomials = nullptr;  // MajoranaTable::coefficients
  Transitions transitions;
};

/// Shares of particles that follow a path each, of which some are counted by a screen.
struct ShareCount {
  const std::uint64_t* shares = nullptr;  // [level][padded]
  const std::uint64_t* hits = nullptr;    // [path][padded] masks: whether that path is counted
  const int* levels = nullptr;            // [path] whose shares follow it
  int paths = 0, padded = 0;
  double efficiency = 1;  // share that is counted
};

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
/// One zone of a region with its wall and step.
struct RegionZone {
  SpinZone field;
  double wall_radius = 0;         // [m]
  double wall_x = 0, wall_z = 0;  // [m] its centre
  int wall_part = 0;
  double step = 0;        // [s]
  int sights_passed = 0;  // of the region, up to its end
  bool operator==(const RegionZone&) const = default;
};
/// Touching fields that turn the velocity: dv/dt = W x v, W = turn - (turn . S) S where `along_spin` is taken
/// off.
struct Region {
  RandomKey key;
  const RegionZone* zones = nullptr;
  const RegionEdge* edges = nullptr;  // edges[i] is crossed between zones i and i+1; zone_count - 1 of them
  int zone_count = 0;
  bool take_off_spin_component = false;  // closure torque
  double most_way = 0;            // [m] flown in one zone at one visit; what goes on for longer gives up
  std::uint64_t most_visits = 0;  // of zones
  // Planes that are looked at, ascending. Nothing happens there: steps go on across them. `seen` takes for
  // each of them, where it is crossed forward for the first time, a particle's state in its own row.
  BatchView* seen = nullptr;
  int sight_count = 0;
};
/// How a particle's flight through a region ended, in the batch's scratch column: an end, or base + zone or
/// edge.
namespace region_end {
inline constexpr std::uint64_t forward = 0, backwards = 1, gave_up = 2;
inline constexpr std::uint64_t wall_of_zone = 16, stopped_at_edge = 1 << 16, caught_at_edge = 1 << 17;
}  // namespace region_end

/// Receives every step of the batch's first particle: time, place, velocity, spin.
struct StepRecorder {
  void (*record)(void* self, double t, const double* place, const double* velocity,
                 const double* spin) = nullptr;
  void* self = nullptr;
};

struct Kernels {
  void (*emit)(const Emission&, std::uint64_t first_particle, BatchView&);
  void (*drift)(double y, BatchView&);
  std::uint64_t (*pass)(const Aperture&, BatchView&);  // returns the weight that stopped [quanta]
  // Bins in scratch, ~0: not counted. What was caught weighs what was counted of it.
  Caught (*screen)(const Screen&, BatchView&);
  void (*align)(const Alignment&, const RandomKey&, BatchView&);
  /// Carries the spins of what flies through the zones.
  void (*precess)(const SpinZone*, int zone_count, const RandomKey&, BatchView&);
  std::uint64_t (*filter)(const Filter&, BatchView&);  // returns the weight that stopped [quanta]
  /// The shares of each weight that are found in each level, a column for each: floored, the largest takes
  /// the rest.
  void (*outcomes)(const LevelQuestion&, const BatchView&, const std::uint64_t* weights,
                   std::uint64_t* shares);
  /// What a screen counts of each share, a column of counts for each path, and of each particle in all. Sums
  /// are by path; of particles they come last, at index `paths`.
  void (*count_shares)(const ShareCount&, std::uint64_t* counts, std::uint64_t* totals, LevelSums&);
  /// What flies gets one level, drawn by its shares, and the state is that level from then on. Numbers are
  /// drawn for that part.
  void (*collapse)(const LevelQuestion&, int part, BatchView&);
  /// The batch must be referred to the magnet's begin. Returns the weight that stopped at its walls [quanta].
  std::uint64_t (*deflect)(const Deflection&, BatchView&);
  std::uint64_t (*steer)(const Steering&, BatchView&);  // likewise
  void (*project)(const Projection&, const BatchView&, LevelSums&);
  void (*turn)(const Region&, BatchView&, const StepRecorder*);
  // For tallies; columns are `padded` long. The weight of what flies through an opening, else 0.
  void (*cross)(const Aperture&, const BatchView&, std::uint64_t* weights);
  void (*measure)(const Gauge&, const BatchView&, const std::uint64_t* weights, double* values);
  // The angle or the projection, or the probability of each outcome from m = I down to -I, a column for each.
  void (*measure_spin)(const SpinGauge&, const BatchView&, const std::uint64_t* weights, double* values);
};

/// The kernels of an instruction set that this machine supports.
const Kernels& kernels_for(Isa);

}  // namespace rabiline
