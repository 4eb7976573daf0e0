#pragma once
// Hand-written loops: how fast the bare arithmetic of an experiment goes on this machine, without a program
// around it. They need AVX-512, take approximate reciprocals and sum in floating point: all that the kernels
// must not do.
#include <cstdint>
#include <vector>

#include "bench/period_table.hpp"
#include "field/magnet_shape.hpp"
#include "field/map_shape.hpp"
#include "transport/kernels.hpp"

namespace rabiline::bench {

/// Rabi's closed form at one frequency: P = most sin^2(half_turn_per_slowness / v).
struct RabiLine {
  double most = 0;
  double half_turn_per_slowness = 0;  // [m/s]
};
struct FlipSums {
  double p = 0, p_squared = 0;
};

/// For each particle: draw its normal speed, its flip probability, sums of P and P^2. The same random numbers
/// as the program's, so that the sums agree; each particle draws its own, or two share a draw as in the
/// program.
FlipSums normal_beam(const Emission&, const RabiLine&, std::uint64_t particles);
FlipSums paired_normal_beam(const Emission&, const RabiLine&, std::uint64_t particles);
/// As above with speeds v^3 exp(-v^2/a^2), a = SpeedDraw::mean, for comparison with other programs.
FlipSums flux_weighted_beam(const Emission&, const RabiLine&, std::uint64_t particles);
/// Each particle's speed is drawn once and serves all lines; sums[line].
void scan_of_normal_beam(const Emission&, const std::vector<RabiLine>&, std::uint64_t particles,
                         FlipSums* sums);

/// As normal_beam, with a random phase for each particle in a whole oscillating field from `begin` to `end`
/// [m].
FlipSums oscillating_beam(const Emission&, const PeriodTable&, const DriveTerm&, double begin, double end,
                          std::uint64_t particles);

/// Place, velocity and spin in the laboratory.
struct Particle {
  double place[3], velocity[3], spin[3];
};
/// Flies `packs` equal packs of 8 particles through `steps` whole steps of a zone with one rotating field
/// under closure `torque`, from time t on, and returns the last particle. No edge, no wall, nothing drawn.
Particle turning_flight(const SpinZone&, double step, double t, const Particle&, int steps, int packs);

/// A spin along z in a field that turns about z at omega, w = (w1 cos, w1 sin, w0): its z after `steps` steps
/// of Magnus' fourth order in the laboratory, eight spins beside each other, `packs` times.
double magnus_spin(double w0, double w1, double omega, double step, int steps, int packs);

/// Leapfrog steps across the field of two wires, at rest at (x, z) before the first one, dv/dt = -pull grad
/// |B|, by bare instructions and by the kernels' function: where the first of eight particles ends along z
/// [m].
double wires_by_hand(const MagnetShape&, double pull, double x, double z, double step, int steps, int packs);
double wires_as_flown(const MagnetShape&, double pull, double x, double z, double step, int steps, int packs);

/// Leapfrog steps in the gradient of |B| of a map, by bare instructions and by the kernels' function: where
/// the first of eight particles ends across the beam [m].
double leapfrog_by_hand(const MapShape&, int steps, int packs);
double leapfrog_as_flown(const MapShape&, int steps, int packs);

}  // namespace rabiline::bench
