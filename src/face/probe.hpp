#pragma once
// The field at a place, and whose it is.
#include "beamline/beamline.hpp"
#include "rabiline.hpp"

namespace rabiline {

/// Of a beamline without fault, at a place [m] and a time [s].
Probed probe_of(const Beamline&, const Vector3& place, double time);

}  // namespace rabiline
