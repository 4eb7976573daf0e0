#pragma once
// How fast the probabilities behind fields and filters change with the slowness.
#include <optional>
#include <string_view>

#include "transport/spin_path.hpp"

namespace rabiline {

/// The angle by which spins turn at most, over the slowness [rad m/s], where that is all that their flip
/// probability depends on: from the levels along one axis, through fields and filters that every particle
/// meets alike. Where it depends on anything else: why. `pulsed`: particles are emitted at different times.
///
/// In a frame that turns at omega about the axis of a field that does so too, a spin turns by s A(y) + B(y)
/// along the way. A change of frames at y is a turn by omega y s, as clocks and particles start together.
/// What a filter lets pass is linear in the weight and the weighted spin that reach it. So a probability is a
/// function of s of exponential type, which is the sum of these angles, and its derivatives are bounded by
/// Bernstein's inequality.
std::optional<double> turning_along(const SpinPath&, bool pulsed, std::string_view& why_not);

}  // namespace rabiline
