#pragma once
// The path of single particles, by the same stages and kernels as a run.
#include "plan/plan.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// The flight of one particle, by its number in the run, through the beamline at one scan point. Under a law
/// that moves with the spin, every step in a region is recorded; straight flights by their ends. The spin is
/// that of the vector laws at recorded places, NaN under `quantum`, and NaN behind a field that turned it
/// while nothing was recorded. Throws std::out_of_range for a particle that the run does not have.
Track trace(const Beamline&, std::uint64_t particle, Isa);

}  // namespace rabiline
