// Gravity along the beam: speeds change, and times, places and spins with them.
#include <gtest/gtest.h>

#include <cmath>

#include "constants.hpp"
#include "physics/agreement.hpp"
#include "physics/suggested.hpp"
#include "simulation/trace.hpp"

namespace rabiline::test::vertical_flight_test {
namespace {

constexpr double g = 9.81;

/// Slow neutrons that rise, to a wide screen at 1 m, or fall.
Beamline rising(double speed, std::vector<PlacedPart> parts, double sign = -1) {
  Beamline b;
  b.title = "rising";
  b.species = {{neutron(), 1}};
  b.law = ClassicalLaw{};
  b.source = {SingleSpeed{speed}, Rectangle{0, 0}, ParallelDirection{}};
  b.source.spin = PolarisedSpin{{1, 0, 0}, 1};
  b.gravity = Gravity{g, {0, sign, 0}};
  b.parts = std::move(parts);
  b.parts.push_back(place("screen", 1, Detector{Rectangle{1, 1}, {1, 1}, {}}));
  b.particles = 8;
  b.seed = 1;
  return b;
}
Track fly(const Beamline& b) { return trace(b, 0, best_isa()); }

/// v^2 = v_0^2 + 2 g h, t = (v - v_0)/g.
double speed_at(double start, double gravity, double height) {
  return std::sqrt(start * start + 2 * gravity * height);
}
double time_to(double start, double gravity, double height) {
  return (speed_at(start, gravity, height) - start) / gravity;
}

TEST(Track, FollowsTheParabolaOfAFallAcrossTheBeam) {
  const double speed = 10;
  Beamline b = rising(speed, {place("B", 0.3, UniformField{0.2, 1e-6, {}})});
  b.gravity->direction = {0, 0, -1};
  const Track track = fly(b);
  double widest = 0;
  for (std::size_t i = 0; i < track.y.size(); ++i) {
    EXPECT_NEAR(track.z[i], -g / 2 * std::pow(track.y[i] / speed, 2), 1e-12);
    if (i > 0) widest = std::max(widest, track.y[i] - track.y[i - 1]);
  }
  EXPECT_LT(widest, 0.13);  // an eighth of the way: chords are within 1/64 of the fall
}

TEST(FreeFallAlongTheBeam, ChangesTheSpeedByTheHeight) {
  for (const double sign : {-1.0, 1.0}) {
    const Track t = fly(rising(5, {}, sign));
    expect_agreement(
        t.vy.back(), [&](double s) { return speed_at(5, s * sign * g, 1); }, 1e-10, "g");
    expect_agreement(
        t.t.back(), [&](double s) { return time_to(5, s * sign * g, 1); }, 1e-11, "g");
    EXPECT_EQ(t.fate, "detected");
  }
}

/// v_0^2/2g = 0.815 m.
TEST(FreeFallAlongTheBeam, TurnsBackWhatIsTooSlowToReachTheHeight) {
  const Track t = fly(rising(4, {}));
  EXPECT_EQ(t.fate, "left_backwards");
  EXPECT_NEAR(t.vy.back(), -4, 1e-9);
  EXPECT_NEAR(t.t.back(), 8 / g, 1e-9);
}

TEST(FreeFallAlongTheBeam, LetsSpinsPrecessForTheTimeThatTheyStay) {
  const double field = 1e-6;
  const Track t = fly(rising(5, {place("B", 0.3, UniformField{0.4, field, {}})}));
  const auto azimuth = [&](double s) {
    const double turned = -gamma_n * field * (time_to(5, -s * g, 0.7) - time_to(5, -s * g, 0.3));
    return turned - two_pi * std::round(turned / two_pi);
  };
  expect_agreement(std::atan2(t.sy.back(), t.sx.back()), azimuth, 1e-8, "g");
}

TEST(FreeFallAlongTheBeam, MovesWhatFliesAskewThroughSlitsByTheTime) {
  Slit slit;
  slit.opening = Rectangle{2e-3, 2e-3};
  const double askew = 0.01, vy = 5 * std::cos(askew), vx = 5 * std::sin(askew);
  for (const double miss : {0.0, 0.9e-3, 1.1e-3}) {
    Beamline b = rising(5, {place("slit", 0.6, slit)});
    b.source.tilt.z = -askew;  // towards +x
    const double x = vx * time_to(vy, -g, 0.6);
    std::get<Slit>(b.parts[0].part).offset.x = x + miss;
    const Track t = fly(b);
    EXPECT_EQ(t.fate, miss > 1e-3 ? "stopped" : "detected") << miss;
    if (miss <= 1e-3) {
      EXPECT_NEAR(t.x.back(), vx * time_to(vy, -g, 1), 1e-10);
    }
  }
}

TEST(FreeFallAlongTheBeam, ThatGoesToZeroIsStraightFlight) {
  Beamline b = rising(5, {place("B", 0.3, UniformField{0.4, 1e-6, {}})});
  b.gravity = Gravity{1e-12, {0, -1, 0}};
  const Track with = fly(b);
  b.gravity.reset();
  const Track without = fly(b);
  EXPECT_NEAR(with.t.back(), without.t.back(), 1e-12);
  EXPECT_NEAR(with.sx.back(), without.sx.back(), 1e-10);
  EXPECT_NEAR(with.sy.back(), without.sy.back(), 1e-10);
}

TEST(FreeFallAlongTheBeam, IsInTheCheckThatEveryRunMakes) {
  const auto found = check_of(rising(5, {place("B", 0.3, UniformField{0.4, 1e-6, {}})}));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->particles, 8U);
  EXPECT_LT(found->largest(), 1e-6);
}

}  // namespace
}  // namespace rabiline::test::vertical_flight_test
