#pragma once
// Ordinary differential equations of the small models, by GSL.
#include <functional>
#include <span>
#include <vector>

namespace rabiline {

/// dy/dt = f(t, y): reads the state, fills the derivative.
using Derivative = std::function<void(double t, std::span<const double> y, std::span<double> derivative)>;

/// The state at each time, a row each, by Runge-Kutta-Prince-Dormand 8(7) with the error of each step held
/// below `tolerance` of 1 and of each component: states are best scaled to be of order 1. `times` ascend and
/// begin with that of `start`. Throws std::runtime_error where steps become too short.
std::vector<std::vector<double>> integrate(const Derivative&, std::vector<double> start,
                                           std::span<const double> times, double tolerance = 1e-13);

}  // namespace rabiline
