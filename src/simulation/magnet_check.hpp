#pragma once
// Paths through deflecting magnets by an independent integration of the same force.
#include <optional>

#include "particle/batch.hpp"
#include "transport/stages/deflection.hpp"
#include "transport/stages/steering.hpp"

namespace rabiline {

/// Place and velocity across the beam [m], [m/s].
struct AcrossBeam {
  double x = 0, z = 0, vx = 0, vz = 0;
};
/// Where a particle of a batch at a magnet's begin comes to at its end, walls left out: GSL's rk8pd in time,
/// with grad |B| = |B| (F'/F)* of the field as an analytic function F of x + i z. Evaluations of the force
/// are counted; nothing where they come to more than `most`.
std::optional<AcrossBeam> integrated_through(const Steering&, const BatchView&, int particle,
                                             long& evaluations, long most);
std::optional<AcrossBeam> integrated_through(const Deflection&, const BatchView&, int particle,
                                             long& evaluations, long most);

}  // namespace rabiline
