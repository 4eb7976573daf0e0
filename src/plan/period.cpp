#include "plan/period.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
#include "core/vector3.hpp"
#include "plan/zones.hpp"

namespace rabiline {
namespace {

using constants::two_pi;
constexpr int samples = 128;  // of the period: of harmonics beyond 64 none is left

/// (cos(a/2), u sin(a/2)) of a right-handed turn by a about u.
struct Quaternion {
  double w = 1;
  Vector3 u;
};
Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.w - dot(a.u, b.u), a.w * b.u + b.w * a.u + cross(a.u, b.u)};
}
Quaternion turn_by(const Vector3& rotation) {
  const double angle = length_of(rotation);
  return {portable::cos(angle / 2), (angle > 0 ? portable::sin(angle / 2) / angle : 0.5) * rotation};
}

Vector3 axis_at(const double* v) { return {v[0], v[1], v[2]}; }

/// The angular velocity of the spin [rad/s] at an angle of the clock.
Vector3 rate_at(const SpinZone& zone, double angle) {
  Vector3 rate = zone.spin_rate * axis_at(zone.frame + 6);
  for (int k = 0; k < zone.drives; ++k) {
    const DriveTerm& drive = zone.drive[k];
    const double at = angle + drive.phase;
    rate = rate + drive.spin_rate *
                      (portable::cos(at) * axis_at(drive.first) + portable::sin(at) * axis_at(drive.second));
  }
  return rate;
}

/// Fourth-order Magnus steps (Blanes, Casas, Oteo and Ros 2009, eq. 253).
Quaternion step(const SpinZone& zone, double angle, double time) {
  constexpr double gauss = 0.28867513459481288;  // sqrt(3)/6
  const double turn = zone.drive[0].omega * time;
  const Vector3 first = rate_at(zone, angle + (0.5 - gauss) * turn),
                second = rate_at(zone, angle + (0.5 + gauss) * turn);
  return turn_by((time / 2) * (first + second) + (gauss / 2 * time * time) * cross(second, first));
}

}  // namespace

bool has_one_clock(const SpinZone& zone) {
  const DriveTerm& clock = zone.drive[0];
  if (zone.drives == 0 || clock.omega == 0) return false;
  return std::all_of(zone.drive, zone.drive + zone.drives, [&](const DriveTerm& drive) {
    return drive.omega == clock.omega && drive.oscillator == clock.oscillator &&
           (drive.oscillator < 0 || drive.random_turn == clock.random_turn) && drive.twist == 0 &&
           drive.envelope.shape == Shape::rectangular && !is_shaped_otherwise(drive);
  });
}

void repeat_period(SpinZone& zone, double speed) {
  constexpr double fewest_periods = 4, left_out = 1e-11;
  if (zone.kind != ZoneKind::general || !has_one_clock(zone)) return;
  const double omega = zone.drive[0].omega, period = two_pi / std::abs(omega);
  if ((zone.end - zone.begin) / speed < fewest_periods * period) return;
  double fastest = std::abs(zone.spin_rate);
  for (int k = 0; k < zone.drives; ++k) fastest += std::abs(zone.drive[k].spin_rate);
  const double turns = fastest / std::abs(omega);
  if (turns > most_harmonics) return;
  const int steps = static_cast<int>(std::ceil(8 * std::max(1.0, turns)));  // in each 128th of the period
  std::array<Quaternion, samples + 1> from_begin;
  for (int j = 0; j < samples; ++j) {
    Quaternion q = from_begin[static_cast<std::size_t>(j)];
    for (int i = 0; i < steps; ++i) {
      const double done = (j + static_cast<double>(i) / steps) / samples;
      q = step(zone, omega * period * done, period / samples / steps) * q;
    }
    from_begin[static_cast<std::size_t>(j) + 1] = q;
  }
  const Quaternion& whole = from_begin[samples];
  const double sine = length_of(whole.u), angle = 2 * portable::atan2(sine, whole.w);
  const Vector3 axis = sine > 0 ? (1 / sine) * whole.u : Vector3{0, 0, 1};
  FloquetForm form;
  form.omega = omega;
  form.rate = angle / period;
  form.axis[0] = axis.x, form.axis[1] = axis.y, form.axis[2] = axis.z;
  double size[most_harmonics + 1] = {};
  for (int k = 0; k <= most_harmonics; ++k)
    for (int j = 0; j < samples; ++j) {
      const double part = static_cast<double>(j) / samples, at = (omega < 0 ? -k : k) * two_pi * part;
      const Quaternion p = from_begin[static_cast<std::size_t>(j)] * turn_by((-angle * part) * axis);
      const double values[4] = {p.w, p.u.x, p.u.y, p.u.z};
      for (int i = 0; i < 4; ++i) {
        const double share = (k == 0 ? 1.0 : 2.0) / samples * values[i];
        form.cosine[k][i] += share * portable::cos(at);
        form.sine[k][i] += share * portable::sin(at);
      }
    }
  for (int k = 0; k <= most_harmonics; ++k)
    for (int i = 0; i < 4; ++i)
      size[k] = std::max({size[k], std::abs(form.cosine[k][i]), std::abs(form.sine[k][i])});
  form.harmonics = most_harmonics;
  while (form.harmonics > 0 && size[form.harmonics] < left_out) --form.harmonics;
  if (form.harmonics == most_harmonics) return;  // those beyond may be as large
  for (int k = form.harmonics + 1; k <= most_harmonics; ++k)
    for (int i = 0; i < 4; ++i) form.cosine[k][i] = form.sine[k][i] = 0;
  zone.kind = ZoneKind::periodic;
  zone.step = 0;
  zone.floquet = form;
}

}  // namespace rabiline
