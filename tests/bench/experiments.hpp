#pragma once
// What is timed, as experiments built in code.
#include "bench/limits.hpp"
#include "field/field_map.hpp"
#include "plan/plan.hpp"

namespace rabiline::bench {

/// Neutrons from an opening through two slits and one zone of a rotating field to a screen of 80 x 80 bins,
/// under `quantum`: `points` frequencies around resonance.
Experiment two_level_beamline(int points, std::uint64_t particles, bool polarised = false);
/// Rabi's apparatus: an oven, slits, magnet A, a field C with a radio frequency, magnet B that undoes what A
/// did, and a narrow detector; spin 1/2 or 3/2, weights split over the levels.
Experiment rabis_apparatus(int points, std::uint64_t particles, int twice_spin, Bins);
/// The suggested experiment under `dorado` at `points` frequencies around the Larmor frequency.
Experiment suggested_experiment(int points, std::uint64_t particles);

/// Spins of one speed through a rotating field whose size is half a sine, carried by steps under `classical`.
Experiment profiled_field(std::uint64_t particles);
/// Polarised neutrons of normal speeds through a whole oscillating field, each at a phase of its own, under
/// `quantum`.
Experiment oscillating_field(std::uint64_t particles);
/// The first zone of such a kind.
const SpinZone& zone_of(const Plan&, ZoneKind);
/// The magnet of Kusch, Millman and Rabi's beam of potassium: two wires 1 cm apart.
MagnetShape two_wires();

/// The shipped caesium clock.
Experiment clock(int points, std::uint64_t particles);

/// The field of a ring of current of 12 mm, 5 mm beside it, on 64^3 nodes in 16 mm.
FieldMap map_of_64();

/// Rabi's line of the plan's closed form at each scan point, in order.
std::vector<RabiLine> lines_of(const Plan&);
const Emission& emission_of(const Plan&);
/// The plan's only region.
const TurningRegion& region_of(const Plan&);
/// Steps that a particle of this speed takes straight through a region.
double steps_through(const TurningRegion&, double speed);

}  // namespace rabiline::bench
