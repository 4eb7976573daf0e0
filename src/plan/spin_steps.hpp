#pragma once
// How long the steps are that carry spins through fields without a closed form.
#include "transport/kernels.hpp"

namespace rabiline {

/// What needs more of them through one zone is refused.
inline constexpr double most_spin_steps = 1e8;

/// How fast anything changes in a zone.
struct SpinPace {
  double rate;     // [rad/s] the fastest turning
  double feature;  // [s] in which the size of a drive rises and falls; infinite where it does not: six
                   // standard deviations of a gaussian
};

/// [s] As many steps per turn and per rise and fall as follow the fields, whatever the tolerance.
double usual_step(const SpinPace&);
/// [s] After which the error of a spin's angle in the whole zone is `allowed` [rad].
double step_within(const SpinPace&, const SpinZone&, double speed, double allowed);

}  // namespace rabiline
