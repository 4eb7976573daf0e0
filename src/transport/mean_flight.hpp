#pragma once
// The way along the beam of a particle of the mean speed, for what is reckoned before a flight.
#include <algorithm>
#include <cmath>

#include "beamline/beamline.hpp"

namespace rabiline {

/// Its speed changes by v^2 = v_0^2 + 2 g y under gravity along the beam, and by what electric fields have
/// given it.
struct MeanFlight {
  double speed = 0;   // [m/s] at the source
  double fall = 0;    // [m/s^2] of gravity along the beam
  double gained = 0;  // [m^2/s^2] of v^2/2, by electric fields
  /// [m/s] What turns back before counts as slow.
  double speed_at(double y) const {
    constexpr double slowest = 0.01;  // of the first speed
    const double square = speed * speed + 2 * (fall * y + gained);
    return std::sqrt(std::max(square, slowest * slowest * speed * speed));
  }
  /// [m/s] The length over the time, [s].
  double speed_between(double from, double to) const { return (speed_at(from) + speed_at(to)) / 2; }
  double time(double from, double to) const { return (to - from) / speed_between(from, to); }
};
inline MeanFlight mean_flight(const Beamline& beamline, double mass) {
  const auto& gravity = beamline.gravity;
  return {mean_speed(beamline.source.speed, mass),
          gravity ? gravity->acceleration * gravity->direction.y : 0};
}

}  // namespace rabiline
