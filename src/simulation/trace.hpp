#pragma once
// The path of single particles, by the same stages and kernels as a run.
#include "plan/plan.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// In which a particle follows one branch.
Plan plan_of_tracks(Beamline);

/// The flight of one particle, by its number in the run, through the beamline at one scan point. Under a law
/// that moves with the spin, every step in a region is recorded; straight flights by their ends. The spin is
/// that of the vector laws at recorded places, NaN under `quantum`, and NaN behind a field that turned it
/// while nothing was recorded. The plan is that of the beamline's tracks. Throws std::out_of_range for a
/// particle that the run does not have.
Track trace(const Beamline&, const Plan&, std::uint64_t particle, Isa);
inline Track trace(const Beamline& beamline, std::uint64_t particle, Isa isa) {
  return trace(beamline, plan_of_tracks(beamline), particle, isa);
}

}  // namespace rabiline
