#include "plan/spin_turning.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rabiline::spin_turning_test {
namespace {

constexpr double larmor = 5e4, omega = 4.9e4, rabi = 3e3;  // [rad/s]

SpinZone still(double begin, double end) {
  SpinZone zone;
  zone.begin = begin;
  zone.end = end;
  zone.spin_rate = larmor;
  return zone;
}
SpinZone turning(double begin, double end, double clock, int oscillator = -1) {
  SpinZone zone = still(begin, end);
  zone.kind = ZoneKind::rotating;
  zone.drives = 1;
  zone.drive[0].spin_rate = rabi;
  zone.drive[0].omega = clock;
  zone.drive[0].oscillator = oscillator;
  return zone;
}
std::optional<double> angle(const UnitVector& start, std::vector<SpinZone> zones, bool pulsed = false) {
  SpinPath path;
  path.levels = 2;
  path.start = start;
  path.zones = std::move(zones);
  std::string_view why;
  return turning_along(path, pulsed, why);
}
const UnitVector x{1, 0, 0}, z{0, 0, 1};
const double effective = std::hypot(larmor - omega, rabi);

TEST(SpinTurning, FromALevelIsThatInTheFrameOfTheClock) {
  EXPECT_NEAR(angle(z, {still(0, 0.2), turning(0.2, 0.3, omega)}).value(), 0.1 * effective, 1e-9);
  EXPECT_NEAR(
      angle(z, {turning(0, 0.1, omega), still(0.1, 0.5), turning(0.5, 0.6, omega), still(0.6, 1)}).value(),
      0.2 * effective + 0.4 * (larmor - omega), 1e-9);
}
TEST(SpinTurning, AcrossZCountsThePhaseOfTheClockAtArrival) {
  EXPECT_NEAR(angle(x, {still(0, 0.2), turning(0.2, 0.3, omega)}).value(),
              0.2 * (larmor - omega) + 0.1 * effective, 1e-9);
  // Without a field in front of it the spin stands while the clock goes on.
  EXPECT_NEAR(angle(x, {turning(0.2, 0.3, omega)}).value(), 0.2 * omega + 0.1 * effective, 1e-9);
}
TEST(SpinTurning, CountsWhatOneClockIsAheadOfAnother) {
  EXPECT_NEAR(angle(z, {turning(0.2, 0.3, omega), turning(0.3, 0.4, -omega)}).value(),
              0.1 * effective + 0.3 * 2 * omega + 0.1 * std::hypot(larmor + omega, rabi), 1e-9);
}
TEST(SpinTurning, IsNotThatOfTheSlownessWherePhasesDiffer) {
  const std::vector<SpinZone> own{turning(0.2, 0.3, omega, 4)},
      two{turning(0.2, 0.3, omega), turning(0.3, 0.4, -omega)};
  EXPECT_TRUE(angle(z, own));
  EXPECT_FALSE(angle(x, own));
  EXPECT_TRUE(angle(z, {turning(0.2, 0.3, omega)}, true));
  EXPECT_FALSE(angle(x, {turning(0.2, 0.3, omega)}, true));
  EXPECT_TRUE(angle(x, {still(0, 1)}, true));
  EXPECT_FALSE(angle(z, two, true));
}
TEST(SpinTurning, OfAFieldThatPointsElsewhereIsThatInTheLaboratory) {
  SpinZone tilted = still(0.3, 0.5);
  tilted.turned = true;
  EXPECT_NEAR(angle(z, {tilted}).value(), 0.2 * larmor, 1e-9);
  EXPECT_NEAR(angle(z, {turning(0.2, 0.3, omega), tilted}).value(),
              0.1 * effective + 0.3 * omega + 0.2 * larmor, 1e-9);
}

}  // namespace
}  // namespace rabiline::spin_turning_test
