#pragma once
// What becomes of scan points as they are finished.
#include "rabiline.hpp"
#include "simulation/effects.hpp"
#include "simulation/form.hpp"

namespace rabiline {

/// Looks at them, and hands them on where somebody wants them. Both arguments must live as long.
TakePoints take_points(const RunSettings&, Effects&);

}  // namespace rabiline
