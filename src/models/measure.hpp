#pragma once
// What is read off a motion: turns, circles, changes.
#include <optional>
#include <span>
#include <vector>

#include "core/vector3.hpp"

namespace rabiline {

/// The angle of each vector about a unit axis, right-handed, from the first one on [rad]; it does not jump,
/// so that vectors must turn by less than half a turn from one to the next.
std::vector<double> angles_about(const Vector3& axis, std::span<const Vector3> vectors);

/// The radius of the circle that fits x and y of the places best (Kasa 1976: least squares of r^2); nothing
/// where they lie on a line.
std::optional<double> radius_of(std::span<const Vector3> places);

/// The slope of values over evenly spaced times, what swings within being averaged out: least squares with
/// weights sin^4 that vanish at both ends.
double mean_rate(std::span<const double> times, std::span<const double> values);

/// The largest |x - x0|, x0 the first.
double largest_change(std::span<const double> values);

}  // namespace rabiline
