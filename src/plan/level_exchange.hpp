#pragma once
// Which levels of an atom exchange next to nothing on a way, because their energies are far from each other.
#include "beamline/beamline.hpp"
#include "transport/level_way.hpp"

namespace rabiline {

/// [Hz] By how much F must differ to exchange nothing (level_fields), where static fields turn at once by
/// `turned` [T] at most. `speed` [m/s].
double far_apart(const Species&, const LevelFields&, double speed, double turned, const Source&);

}  // namespace rabiline
