#pragma once
// Deflecting magnets as one species sees them.
#include <optional>
#include <vector>

#include "beamline/beamline.hpp"
#include "plan/sampled_tables.hpp"
#include "section/section.hpp"
#include "transport/stages.hpp"

namespace rabiline {

/// Whether magnets deflect under a law: the hypothesis replaces the force grad(mu.B).
bool deflects(const Law&);

/// The path through a magnet, its gap included: a parabola where the force is constant, else stepped.
/// `levels`: 0 under a vector law.
void add_deflection(const Plane&, const MagnetTerm&, const Species&, int levels, SampledTables&,
                    std::vector<Stage>& chain);

/// What a stepped magnet does at one place: at the beam's height, or of a multipole halfway to the poles.
struct SteeringOutlook {
  double field = 0, gradient = 0;  // [T], [T/m] of |B|
  double acceleration = 0;         // [m/s^2] of the largest moment
  double rate = 0;                 // [1/s] w of Steering, for particles along the beam
  double steps = 0;                // about, at that speed
};
SteeringOutlook outlook_of(const Steering&, double speed);

/// Where what enters along the beam's axis in a level meets a wall [m]; nothing where it comes through.
std::optional<double> stopped_at(const Steering&, int level, double speed);

}  // namespace rabiline
