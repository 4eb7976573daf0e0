#pragma once
// How well the place of a line along a scan is known.
#include "simulation/result.hpp"

namespace rabiline {

/// Standard error of the shift c with which the line itself fits: of a + b f(x - c), f the curve of
/// `detected`, a and b free, all points weighing the same. Infinite where chance makes as much of its slopes
/// as the line does. x: the values of the only axis.
double error_of_centre(const std::vector<double>& x, const DetectorResult&);

}  // namespace rabiline
