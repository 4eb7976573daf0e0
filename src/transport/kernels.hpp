#pragma once
// The loops over particles, compiled once for each instruction set, and the plain values they work on.
// Every kernel gives the same bits on every instruction set.
#include <cstdint>

#include "core/isa.hpp"
#include "particle/batch.hpp"
#include "tally/quantity.hpp"

namespace rabiline {

/// What a random number is drawn for: part of the counter, so that no two uses share numbers.
namespace purpose {
inline constexpr unsigned speed = 1, place = 2, direction = 3, spin = 4, align = 5, oscillator = 6;
}

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
  bool operator==(const Aperture&) const = default;
};

enum class SpeedKind { single, gaussian };
enum class DirectionKind { parallel, gaussian, cone, aimed };

/// How a batch begins.
struct Emission {
  RandomKey key;
  SpeedKind speed_kind = SpeedKind::single;
  double speed = 0, speed_sigma = 0;  // [m/s]
  Aperture opening;                   // at y = 0
  DirectionKind direction = DirectionKind::parallel;
  double spread_x = 0, spread_z = 0;  // slopes (gaussian); 1 - cos(half angle) in spread_x (cone)
  Aperture target;                    // (aimed)
  int levels = 0;  // quantum: how many levels, uniformly populated; 0: a random direction of S
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
  double probability = 1;  // that S comes out along `spin_sign`
  double spin_sign = 1;    // +1 or -1: S_z that puts the moment along the field
  int levels = 0;          // quantum: how many levels; 0: a vector law
  int part = 0;
  bool operator==(const Alignment&) const = default;
};

/// A rotating field as one species sees it.
struct DriveTerm {
  double spin_rate = 0;  // [rad/s] -gamma H0: turns the spin
  double turn_rate = 0;  // [rad/s] turns the velocity, strength included
  double omega = 0;      // [rad/s] signed, about +z
  double phase = 0;      // [rad] at emission
  int oscillator = -1;   // part number that a random phase is drawn for; -1: none is drawn
  bool operator==(const DriveTerm&) const = default;
};
inline constexpr int most_drives = 8;  // rotating fields that may overlap at one place

/// The fields of one section as one species sees them. w = -gamma B turns the spin (dS/dt = w x S).
struct SpinZone {
  double begin = 0, end = 0;  // [m]
  double spin_rate = 0;       // [rad/s] w_z of the uniform field
  double turn_rate = 0;       // [rad/s] the velocity's turning about z, strength included
  int drives = 0;
  DriveTerm drive[most_drives];
  double step = 0;  // [s] at most, of a stretch where more than one field drives
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
inline constexpr int most_levels = 10;
/// Sums over the particles that the detector caught: of q and of q^2 = high 2^40 + low.
struct LevelSums {
  std::uint64_t q[most_levels] = {};
  std::uint64_t squares_high[most_levels] = {};
  std::int64_t squares_low[most_levels] = {};
};

/// What is asked about each particle where it meets a plane.
struct Gauge {
  Quantity quantity = Quantity::x;
  double y = 0;     // [m] the plane
  double mass = 0;  // [kg]
};
/// What measuring the spin along an axis gives where particles meet a plane.
struct SpinGauge {
  RandomKey key;
  double axis[3] = {0, 0, 1};
  int levels = 0;  // quantum: how many outcomes; 0: a vector law, whose spin has a projection
  const SpinZone* zones = nullptr;  // flown straight since the last projection
  int zone_count = 0;
  const double* polynomials = nullptr;  // MajoranaTable::coefficients
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
  double wall_radius = 0;  // [m]
  int wall_part = 0;
  double step = 0;  // [s]
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
  void (*project)(const Projection&, const BatchView&, LevelSums&);
  void (*turn)(const Region&, BatchView&, const StepRecorder*);
  // For tallies; columns are `padded` long. The weight of what flies through an opening, else 0.
  void (*cross)(const Aperture&, const BatchView&, std::uint64_t* weights);
  void (*measure)(const Gauge&, const BatchView&, const std::uint64_t* weights, double* values);
  // The projection, or the probability of each outcome from m = I down to -I, a column for each.
  void (*measure_spin)(const SpinGauge&, const BatchView&, const std::uint64_t* weights, double* values);
};

/// The kernels of an instruction set that this machine supports.
const Kernels& kernels_for(Isa);

}  // namespace rabiline
