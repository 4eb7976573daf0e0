#pragma once
// The loops over particles, compiled once for each instruction set, and the plain values they work on.
// Every kernel gives the same bits on every instruction set.
#include <cstdint>

#include "core/isa.hpp"
#include "field/envelope.hpp"
#include "field/magnet_shape.hpp"
#include "particle/batch.hpp"
#include "particle/draw.hpp"
#include "spin/level_block.hpp"
#include "tally/quantity.hpp"
#include "transport/kernel.hpp"

namespace rabiline {

/// What a random number is drawn for: part of the counter, so that no two uses share numbers.
namespace purpose {
inline constexpr unsigned speed = 1, place_and_spin = 2, direction = 3, spot = 4, align = 5, oscillator = 6;
inline constexpr unsigned speeds_of_two = 7;  // of the particles 2n and 2n + 1, by n
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
  Fall fall{};
  bool watches_turning = false;  // something asks for adiabaticity
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
/// What a screen took from a batch [quanta], and from how many particles something was counted.
struct Caught {
  std::uint64_t counted = 0, lost = 0;
  int particles = 0;
};

/// A field that turns or swings, as one species sees it: size cos(angle) first + size sin(angle) second,
/// angle = omega t + twist (y - envelope.begin) + phase, and what a sweep and slopes add to it.
struct DriveTerm {
  double spin_rate = 0;                    // [rad/s] -gamma H0: turns the spin
  double turn_rate = 0;                    // [rad/s] turns the velocity, strength included
  double omega = 0;                        // [rad/s] signed, from the first axis towards the second
  double phase = 0;                        // [rad] at emission
  int oscillator = -1;                     // part number that a random phase is drawn for; -1: none is drawn
  double random_turn = 6.283185307179586;  // [rad] that a random number in (0, 1) adds, times it
  double twist = 0;                        // [rad/m]
  Envelope envelope{};                     // of the whole field, not only of this zone
  Sweep sweep{};                           // of omega
  Gate gate{};
  Slopes slopes{};
  bool in_xy = true;                                   // first and second are x and y
  double first[3] = {1, 0, 0}, second[3] = {0, 1, 0};  // in the laboratory
  int part = -1;  // of the beamline, whose field it is; -1: a shaped one's
  bool operator==(const DriveTerm&) const = default;
};
inline constexpr int most_drives = 8;  // rotating fields that may overlap at one place

/// How spins are carried through a zone.
enum class ZoneKind {
  precession,  // one turn about the static field
  rotating,    // one field turns across the static one: closed form in the frame that turns with it
  profiled,    // the same with a size or a rate that changes on the way: steps in that frame
  periodic,    // fields of one clock, the same everywhere: Floquet's form
  general      // steps in the laboratory
};
inline constexpr int most_harmonics = 24;
/// A spin's turning in fields of one period, by Floquet (1883): from the clock's angle a to b it is P(b) R
/// P(a)^-1, R right-handed about the axis by rate (b - a)/omega, and P a rotation that has the fields'
/// period. P is given as the quaternion sum_k cosine_k cos(k a) + sine_k sin(k a).
struct FloquetForm {
  int harmonics = 0;
  double omega = 0;  // [rad/s] of the clock
  double rate = 0;   // [rad/s]
  double axis[3] = {0, 0, 1};
  double cosine[most_harmonics + 1][4] = {}, sine[most_harmonics + 1][4] = {};
  bool operator==(const FloquetForm&) const = default;
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
  double step = 0;        // [s] at most, of what is carried by steps
  FloquetForm floquet{};  // of a periodic zone; its angle is the first drive's without its own phase
  bool operator==(const SpinZone&) const = default;
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
/// Transitions between the levels of an atom on a stretch of the beam, as DrivenLevels has them.
struct Transitions {
  const LevelBlock* blocks = nullptr;
  const int* block_of =
      nullptr;  // [level]; null: the levels are not those of an atom, or nothing drives them
  const int* levels = nullptr;
  const double* numbers = nullptr;
};

struct LevelCourse;  // transport/level_course.hpp

/// How spins are carried on a straight flight, and in which level along the field they are then found: the
/// image of z tells of a point moment, the transitions of an atom (SpinPath).
struct SpinPathView {
  RandomKey key;
  int levels = 2;           // 0: a vector law, whose spin has a projection
  bool from_level = false;  // S untouched so far, along z as the levels: one zone has a closed form
  const SpinZone* zones = nullptr;
  int zone_count = 0;
  const double* polynomials = nullptr;  // MajoranaTable::coefficients
  Transitions transitions;
  const LevelCourse* course = nullptr;  // of an atom, instead, through fields without a closed form
  double axis[3] = {0, 0, 1};           // of a point moment's levels: of what a deflecting magnet finds
};

/// The levels of what a detector caught.
struct Projection {
  SpinPathView path;
  int part = 0;           // the detector
  bool majorana = false;  // quantum: S is the image of z, levels follow from the flip probability
};

/// What measuring the spin along an axis gives where particles meet a plane; or an angle of a spin that is a
/// vector.
struct SpinGauge {
  SpinPathView path;
  Quantity quantity = Quantity::spin;
  double axis[3] = {0, 0, 1};
};

/// A stretch of an axis in equal divisions, the last of which `high` belongs to.
struct Ruler {
  static constexpr std::uint64_t outside = ~std::uint64_t{0};
  double low = 0, high = 1, per_unit = 1;
  int divisions = 1;
};

/// Shares of particles that follow a path each, of which some are counted by a screen.
struct ShareCount {
  const std::uint64_t* shares = nullptr;  // [level][padded]
  const std::uint64_t* hits = nullptr;    // [path][padded] masks: whether that path is counted
  const int* levels = nullptr;            // [path] whose shares follow it
  const std::uint16_t* eights = nullptr;  // of particles, some of which a path has counted, by their number
  const std::size_t* first_eight = nullptr;  // [path], and where those of the last end
  int paths = 0, padded = 0;
  double efficiency = 1;  // share that is counted
};

/// Receives every step of the batch's first particle: time, place, velocity, spin.
struct StepRecorder {
  void (*record)(void* self, double t, const double* place, const double* velocity,
                 const double* spin) = nullptr;
  void* self = nullptr;
};

inline constexpr std::uint64_t no_particle = ~std::uint64_t{0};

RABILINE_KERNEL(emit, void(const Emission&, std::uint64_t first_particle, BatchView&))
/// The shares of each weight that are found in each level, a column for each: floored, the largest takes the
/// rest. The number of a particle that could not be followed, or no_particle.
RABILINE_KERNEL(outcomes, std::uint64_t(const SpinPathView&, const BatchView&, const std::uint64_t* weights,
                                        std::uint64_t* shares))
/// What flies gets one level, drawn by its shares, and the state is that level from then on. Numbers are
/// drawn for that part. Likewise.
RABILINE_KERNEL(collapse, std::uint64_t(const SpinPathView&, int part, BatchView&))
/// What a screen counts of each share, a column of counts for each path (of others than the eights they stay
/// as they are), and of each particle in all. Sums
/// are by path; of particles they come last, at index `paths`.
RABILINE_KERNEL(count_shares,
                void(const ShareCount&, std::uint64_t* counts, std::uint64_t* totals, LevelSums&))
RABILINE_KERNEL(project, void(const Projection&, const BatchView&, LevelSums&))
// For tallies; columns are `padded` long. The weight of what flies through an opening, else 0.
RABILINE_KERNEL(cross, void(const Aperture&, const BatchView&, std::uint64_t* weights))
RABILINE_KERNEL(measure, void(const Gauge&, const BatchView&, const std::uint64_t* weights, double* values))
// The angle or the projection, or the probability of each outcome from m = I down to -I, a column for each.
RABILINE_KERNEL(measure_spin,
                void(const SpinGauge&, const BatchView&, const std::uint64_t* weights, double* values))
// In which division each value is, or Ruler::outside.
RABILINE_KERNEL(mark, void(const Ruler&, const double* values, int padded, std::uint64_t* divisions))

}  // namespace rabiline
