#include "plan/spin_steps.hpp"

#include <algorithm>
#include <cmath>

#include "core/constants.hpp"
#include "plan/zones.hpp"

namespace rabiline {
namespace {

using constants::two_pi;

constexpr double steps_per_turn = 48, steps_per_feature = 64;

/// By how much a drive's part of the fields changes in a zone, all changes added up [rad/s]; of a field that
/// is carried in the frame that turns with it only its size and its rate change.
double variation_of(const SpinZone& zone, const DriveTerm& drive, double speed) {
  const double stay = (zone.end - zone.begin) / speed, size = std::abs(drive.spin_rate),
               swept = std::abs(swept_in_all(drive));
  double rises_and_falls = 0;
  switch (drive.envelope.shape) {
    case Shape::rectangular:
      break;
    case Shape::gaussian:
    case Shape::half_sine:
      rises_and_falls = 2;
      break;
    case Shape::standing_wave:
      rises_and_falls = 2 * drive.envelope.half_waves;
      break;
  }
  if (zone.kind == ZoneKind::profiled)
    return size * rises_and_falls + std::min(swept, std::abs(drive.sweep.rate) * stay);
  return size * (rises_and_falls + (std::abs(drive.omega) + swept + std::abs(drive.twist) * speed) * stay);
}

}  // namespace

double usual_step(const SpinPace& pace) {
  return std::min(two_pi / (steps_per_turn * pace.rate), pace.feature / steps_per_feature);
}

/// Steps of Magnus' fourth order through fields that turn the spin by A(t) leave an angle of c h^4 R^3 times
/// all changes of A, where R is the fastest rate of A and of its changes. c is the largest of what was
/// measured (DECISIONS.md, "Steps of spins follow the tolerance"): where the field is resonant all along.
double step_within(const SpinPace& pace, const SpinZone& zone, double speed, double allowed) {
  constexpr double c = 1.2e-3;
  double changes = 0;
  for (int i = 0; i < zone.drives; ++i) changes += variation_of(zone, zone.drive[i], speed);
  const double rate = std::max(pace.rate, 6 / pace.feature), fourth = c * changes * rate * rate * rate;
  return fourth > 0 ? std::sqrt(std::sqrt(allowed / fourth)) : pace.feature;
}

}  // namespace rabiline
