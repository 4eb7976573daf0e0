#pragma once
// Deflecting magnets as one species sees them.
#include "beamline/beamline.hpp"
#include "section/section.hpp"
#include "transport/stages.hpp"

namespace rabiline {

/// Whether magnets deflect under a law: the hypothesis replaces the force grad(mu.B).
bool deflects(const Law&);

/// F = mu_z dB_z/ds, mu_z = gamma hbar m: the acceleration is that of m = I.
Deflection deflection_of(const Plane&, const MagnetTerm&, const Species&, int levels);

}  // namespace rabiline
