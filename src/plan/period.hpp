#pragma once
// Fields that repeat: one period is worked out for all of them.
#include "transport/kernels.hpp"

namespace rabiline {

/// Whether something drives, all of it at one clock, the same all along and across the way and always.
bool has_one_clock(const SpinZone&);
/// Gives a zone that would be passed in steps Floquet's form, where all its fields follow one clock and are
/// the same all along it, for longer than a few periods at this speed [m/s], and their harmonics are not too
/// many.
void repeat_period(SpinZone&, double speed);

}  // namespace rabiline
