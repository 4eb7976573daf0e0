#include "plan/period.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rabiline::period_test {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;

/// A static field along z with the precession w0 and a field that swings along x, gamma A = swing [rad/s].
SpinZone swinging(double w0, double swing, double omega) {
  SpinZone zone;
  zone.end = 1;
  zone.kind = ZoneKind::general;
  zone.spin_rate = w0;
  zone.step = 1;
  zone.drives = 1;
  zone.drive[0].spin_rate = swing;
  zone.drive[0].omega = omega;
  for (double& component : zone.drive[0].second) component = 0;
  return zone;
}
/// The rate of the turning that is left when the fields' own period is taken off.
double rate_of(double w0, double swing, double omega) {
  SpinZone zone = swinging(w0, swing, omega);
  repeat_period(zone, 1e-6);
  EXPECT_EQ(zone.kind, ZoneKind::periodic);
  return zone.floquet.rate;
}

// H = w0/2 sigma_z + x w/2 cos(wt) sigma_x turns by J0(x) w0 where w0 << w (C. Cohen-Tannoudji, S. Haroche,
// C. R. Acad. Sci. 262, 268 (1966)); elsewhere by an integration of scipy.
TEST(FloquetForm, OfADressedSpinTurnsByItsBesselFunction) {
  constexpr double omega = 1e5, x = 1.189007;
  EXPECT_NEAR(rate_of(1e-2 * omega, x * omega, omega) / (1e-2 * omega), 0.676574, 1e-6);
  EXPECT_NEAR(rate_of(1e-1 * omega, x * omega, omega) / (1e-1 * omega), 0.674523, 1e-6);
  EXPECT_GT(std::abs(rate_of(1e-1 * omega, 1.01 * x * omega, omega) / (1e-1 * omega) - 0.674523), 1e-3);
}

// The flip probability from +z, averaged over time and phase, is (1 - (d rate/d w0)^2)/2 (J. Shirley, Phys.
// Rev. 138, B979 (1965)), highest where the derivative vanishes: w/w0 = 1 + r^2/4 + r^4/64 - ..., r = gamma
// A/2 w0.
TEST(FloquetForm, HasTheResonanceOfBlochAndSiegert) {
  constexpr double w0 = 1e5, r = 0.10025, h = 3;
  const auto slope = [&](double omega) {
    return (rate_of(w0 + h, 2 * r * w0, omega) - rate_of(w0 - h, 2 * r * w0, omega)) / (2 * h);
  };
  double low = 1.001 * w0, high = 1.004 * w0;
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2;
    (slope(low) * slope(middle) <= 0 ? high : low) = middle;
  }
  EXPECT_NEAR(low / w0, 1.002514, 1e-6);
}

TEST(FloquetForm, IsLeftAloneWhereFieldsDoNotRepeatOrHaveTooManyHarmonics) {
  const auto kind_of = [](SpinZone zone, double speed = 1e-6) {
    repeat_period(zone, speed);
    return zone.kind;
  };
  const SpinZone plain = swinging(1e5, 1e4, 1e5);
  EXPECT_EQ(kind_of(plain), ZoneKind::periodic);
  EXPECT_EQ(kind_of(plain, 1e5 / two_pi), ZoneKind::general);  // one period
  EXPECT_EQ(kind_of(swinging(1e5, 1e4, 1e3)), ZoneKind::general);
  SpinZone other = plain;
  other.drive[0].twist = 1;
  EXPECT_EQ(kind_of(other), ZoneKind::general);
  other = plain;
  other.drive[0].envelope.shape = Shape::half_sine;
  EXPECT_EQ(kind_of(other), ZoneKind::general);
  other = plain;
  other.drive[0].sweep = {1e5, 0, 1};
  EXPECT_EQ(kind_of(other), ZoneKind::general);
  other = plain;
  other.drives = 2;
  other.drive[1] = other.drive[0];
  other.drive[1].phase = 1;
  EXPECT_EQ(kind_of(other), ZoneKind::periodic);
  other.drive[1].omega *= 2;
  EXPECT_EQ(kind_of(other), ZoneKind::general);
}

}  // namespace
}  // namespace rabiline::period_test
