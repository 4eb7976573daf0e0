#pragma once
// Deflecting magnets as one species sees them.
#include <vector>

#include "beamline/beamline.hpp"
#include "plan/sampled_tables.hpp"
#include "section/section.hpp"
#include "transport/stage.hpp"

namespace rabiline {

/// [J/T] along z of m = I, or of S along z.
double full_moment(const Species&);

/// The path through a magnet, its gap included: a parabola where the force is constant, else stepped.
/// `levels`: 0 under a vector law. `tolerance`: of the law. `chamber`: its radius, [m] or infinite.
void add_deflection(const Plane&, const MagnetTerm&, const Species&, int levels, double tolerance,
                    double chamber, SampledTables&, std::vector<Stage>& chain);

}  // namespace rabiline
