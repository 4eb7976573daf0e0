#pragma once
// Three levels through a Hamiltonian that changes, by the steps of transport/level_step_lanes.hpp.
#include "transport/kernel.hpp"

namespace rabiline {

/// Energies [rad/s], and <k + 1|H|k>.
template <class Number>
struct Swings {
  Number energy[3], re[2], im[2];
};
/// `swing(rate, phase)` is cos(rate t + phase).
template <class Swing>
auto swings(const Swing& swing, double coupled) {
  using Number = decltype(swing(1.0, 0.0));
  return Swings<Number>{
      {2.5 + 0.8 * swing(0.9, 0.3), 0.3 * swing(1.7, 1.0), 0.0 - 2.9 - 0.5 * swing(1.2, 2.0)},
      {coupled * (0.8 + 0.5 * swing(1.1, 0.0)), coupled * (0.5 * swing(1.6, 0.4))},
      {coupled * (0.6 * swing(0.7, 1.2)), coupled * (0.7 + 0.3 * swing(1.3, 2.1))}};
}

/// Amplitudes behind a time of 3, from the first level, and the sum of what the steps may be off by.
struct SteppedLevels {
  double re[3], im[3], error;
};
/// `coupled`: how strong, where gaps are about 3; `taken_out`: whether energies are taken out of the steps.
RABILINE_KERNEL(step_levels, SteppedLevels(int steps, double coupled, bool taken_out))

}  // namespace rabiline
