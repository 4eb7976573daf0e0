// Monitors where fields turn the velocity: what they see, and that they disturb nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "constants.hpp"
#include "physics/suggested.hpp"
#include "simulation/finish_tallies.hpp"
#include "simulation/trace.hpp"

namespace rabiline::sights_test {
namespace {

using test::axis;
using test::place;
using test::run_points;
using test::suggested;

/// A neutron of 1000 m/s in 1 mT circles with R = 5.457 mm under closure larmor, towards -x.
constexpr double radius = 1000 / (-test::gamma_n * 1e-3);

Beamline circle() {
  Beamline b = suggested(291e3);
  b.law = DoradoLaw{Closure::larmor, 1};
  b.source = {SingleSpeed{1000}, Rectangle{0, 0}, ParallelDirection{}};
  b.chamber.reset();
  b.particles = 16;
  b.parts = {place("B", 0.1, UniformField{0.1, 1e-3, {}}),
             place("screen", 1.2, Detector{Rectangle{4, 4}, {1, 1}, {}})};
  return b;
}
void put(Beamline& b, double at, const Monitor& monitor) {
  b.parts.insert(b.parts.end() - 1, place("M", at, monitor));
}
Monitor planes(std::uint64_t number, double length, std::vector<Tally> tallies = {}) {
  Monitor m{Disc{1}, {}};
  m.planes = number;
  m.length = length;
  m.tallies = std::move(tallies);
  return m;
}

TEST(MonitorInARegion, SeesTheStateOnTheCircleThatAParticleFliesForward) {
  Beamline b = circle();
  put(b, 0.1 + 0.6 * radius,
      planes(1, 0,
             {{"x", {axis(Quantity::x, -2e-3, 0, 1)}},
              {"angle", {axis(Quantity::angle_x, -1, 0, 1)}},
              {"t", {axis(Quantity::time_of_flight, 0, 1e-3, 1)}}}));
  const Result r = run_points({b});
  EXPECT_EQ(r.monitors.at(0).passed, std::vector<double>{1});
  EXPECT_NEAR(r.tallies.at(0).axes.at(0).mean.at(0), -0.2 * radius, 1e-9);
  EXPECT_NEAR(r.tallies.at(1).axes.at(0).mean.at(0), -std::asin(0.6), 1e-7);
  EXPECT_NEAR(r.tallies.at(2).axes.at(0).mean.at(0), (0.1 + radius * std::asin(0.6)) / 1000, 1e-10);
}

TEST(MonitorInARegion, CountsOnceWhatTurnsBackAndNothingThatNeverComes) {
  Beamline b = circle();
  put(b, 0.1 + 0.25 * radius, planes(4, 0.75 * radius));     // at 1/4, 1/2, 3/4 and 1 of the radius
  std::get<Monitor>(b.parts[1].part).length = 0.9 * radius;  // the last one is beyond
  const Result r = run_points({b});
  EXPECT_EQ(r.monitors.at(0).passed, (std::vector<double>{1, 1, 1, 0}));
  EXPECT_EQ(r.monitors[0].planes.size(), 4U);
  for (const FateResult& fate : r.fates)
    EXPECT_EQ(fate.particles.at(0), fate.fate == "left_backwards" ? 16 : 0) << fate.fate;
}

/// Fields so strong, and turning so slowly, that some neutrons wander to and fro.
Beamline wanderers() {
  Beamline b = circle();
  b.law = DoradoLaw{Closure::larmor, 1};
  RotatingField drive;
  drive.length = 0.04;
  drive.amplitude = 3e-3;
  drive.frequency = 40e3;
  drive.sense = Sense::positive;
  drive.phase = {Phase::Kind::random, 0};
  b.parts = {place("B", 0.1, UniformField{0.04, 0.2e-3, {}}), place("drive", 0.1, drive),
             place("screen", 1.2, Detector{Rectangle{1, 1}, {8, 8}, {}})};
  b.particles = 100;
  return b;
}

TEST(MonitorInARegion, CountsAParticleOnceHoweverOftenItCrosses) {
  Beamline b = wanderers();
  const double y = 0.102;
  put(b, y, planes(1, 0, {{"x", {axis(Quantity::x, -1, 1, 1)}}}));
  const Result r = run_points({b});
  int reached = 0, again = 0;
  for (std::uint64_t p = 0; p < b.particles; ++p) {
    const Track t = trace(b, p, best_isa());
    int crossings = 0;
    for (std::size_t i = 1; i < t.y.size(); ++i) crossings += t.y[i - 1] < y && t.y[i] >= y ? 1 : 0;
    reached += crossings > 0 ? 1 : 0;
    again += crossings > 1 ? 1 : 0;
  }
  EXPECT_GT(again, 3);
  EXPECT_LT(reached, 100);
  EXPECT_NEAR(r.monitors.at(0).passed.at(0) * 100, reached, 1e-9);
  EXPECT_NEAR(r.tallies.at(0).counts.at(0), reached, 1e-9);
}

TEST(MonitorInARegion, ChangesNothingElseToTheBit) {
  for (Beamline b : {wanderers(), suggested(291.6e3), suggested(288e3)}) {
    if (b.chamber) b.parts.insert(b.parts.begin() + 3, place("S", 0.45, Slit{Disc{1e-3}, {}}));
    b.particles = std::min<std::uint64_t>(b.particles, 2000);
    const Result alone = run_points({b});
    // Random phases are drawn for the number of a part, so that no monitor stands in front of the field.
    const std::ptrdiff_t first = b.chamber ? 3 : 2;
    // Among others in the slit's plane, before it and behind it, and at a zone's begin and end.
    Beamline seen = b;
    put(seen, 0.101, planes(400, 0.5, {{"x", {axis(Quantity::x, -1e-3, 1e-3, 5)}}}));
    for (const double y : {0.35, 0.45, 0.55}) {
      seen.parts.insert(seen.parts.begin() + first, place("first" + std::to_string(y), y, planes(1, 0)));
      put(seen, y, planes(1, 0));
    }
    const Result looked = run_points({seen});
    EXPECT_EQ(looked.detectors.at(0).counts, alone.detectors.at(0).counts);
    ASSERT_EQ(looked.fates.size(), alone.fates.size());
    for (std::size_t i = 0; i < alone.fates.size(); ++i)
      EXPECT_EQ(looked.fates[i].quanta_low, alone.fates[i].quanta_low) << alone.fates[i].fate;
    EXPECT_EQ(trace(seen, 7, best_isa()).x.back(), trace(b, 7, best_isa()).x.back());
  }
}

TEST(MonitorInARegion, SeesWhatComesBeforeAPartAtTheSamePlaceWhereItStandsFirst) {
  Beamline b = suggested(291.6e3);
  b.parts.insert(b.parts.begin() + 3, place("S", 0.45, Slit{Disc{0.1e-3}, {}}));
  b.parts.insert(b.parts.begin() + 3, place("before", 0.45, planes(1, 0)));
  b.parts.insert(b.parts.begin() + 5, place("behind", 0.45, planes(1, 0)));
  const Result r = run_points({b});
  double stopped = 0;
  for (const FateResult& fate : r.fates)
    if (fate.where == "S") stopped += fate.particles.at(0);
  EXPECT_GT(stopped, 100);
  EXPECT_EQ(r.monitors.at(0).passed.at(0), 1);
  EXPECT_NEAR(r.monitors.at(1).passed.at(0), 1 - stopped / 10000, 1e-12);
}

TEST(MonitorOfSeveralPlanes, CountsAsSoManyMonitorsWould) {
  for (const Law& law : {Law{QuantumLaw{}}, Law{ClassicalLaw{}}, Law{DoradoLaw{}}}) {
    Beamline b = suggested(291.6e3);
    b.law = law;
    b.particles = 500;
    TallyAxis spin = axis(Quantity::spin, -1, 1, 3);
    spin.axis = UnitVector{0, 0.6, 0.8};
    const std::vector<Tally> tallies{{"s", {axis(Quantity::x, -1e-3, 1e-3, 4), spin}}};
    Beamline single = b;
    put(b, 0.25, planes(5, 0.4, tallies));
    for (int i = 0; i < 5; ++i)
      single.parts.insert(
          single.parts.end() - 1,
          place("M" + std::to_string(i), std::lerp(0.25, 0.65, i / 4.0), planes(1, 0, tallies)));
    const Result together = run_points({b}), apart = run_points({single});
    std::vector<double> counts, means, passed;
    for (std::size_t i = 0; i < 5; ++i) {
      const TallyResult& t = apart.tallies.at(i);
      counts.insert(counts.end(), t.counts.begin(), t.counts.end());
      means.push_back(t.axes.at(1).mean.at(0));
      passed.push_back(apart.monitors.at(i).passed.at(0));
    }
    EXPECT_EQ(together.tallies.at(0).counts, counts);
    EXPECT_EQ(together.tallies[0].axes.at(2).mean, means);
    EXPECT_EQ(together.monitors.at(0).passed, passed);
    EXPECT_EQ(together.tallies[0].axes.at(0).quantity, "y");
    EXPECT_NEAR(together.tallies[0].axes[0].edges.at(1), 0.3, 1e-12);
  }
}

/// Angles of spins that start along an axis, in a plane in front of all fields.
Result angles_of(UnitVector along) {
  Beamline b = suggested(291e3);
  b.law = ClassicalLaw{};
  b.parts.erase(b.parts.begin());
  b.source.spin = PolarisedSpin{along, 1};
  b.particles = 9;
  const double pi = std::numbers::pi;
  put(b, 0.2,
      planes(1, 0,
             {{"polar", {axis(Quantity::spin_polar_angle, 0, pi, 180)}},
              {"azimuth", {axis(Quantity::spin_azimuth, -pi, pi, 360)}}}));
  return run_points({b});
}
std::size_t full_bin(const TallyResult& t) {
  const auto full = std::find(t.counts.begin(), t.counts.end(), 9.0);
  EXPECT_NE(full, t.counts.end()) << t.outside[0] << " outside";
  return static_cast<std::size_t>(full - t.counts.begin());
}

TEST(SpinAngles, AreThoseOfTheVectorInEveryQuadrantAndAlongTheAxes) {
  const double r = std::sqrt(0.5);
  const struct {
    UnitVector along;
    std::size_t polar, azimuth;
  } cases[] = {{{0, 0, 1}, 0, 180},      {{0, 0, -1}, 179, 180},     {{1, 0, 0}, 90, 180},
               {{0, 1, 0}, 90, 270},     {{-1, 0, 0}, 90, 359},      {{0, -1, 0}, 90, 90},
               {{0.6, 0, 0.8}, 36, 180}, {{0, 0.6, -0.8}, 143, 270}, {{-r, r, 0}, 90, 315},
               {{-r, -r, 0}, 90, 45}};
  for (const auto& c : cases) {
    const Result r_of_case = angles_of(c.along);
    EXPECT_EQ(full_bin(r_of_case.tallies.at(0)), c.polar)
        << c.along.x << ' ' << c.along.y << ' ' << c.along.z;
    EXPECT_EQ(full_bin(r_of_case.tallies.at(1)), c.azimuth)
        << c.along.x << ' ' << c.along.y << ' ' << c.along.z;
    EXPECT_NEAR(std::cos(r_of_case.tallies[0].axes.at(0).mean.at(0)), c.along.z, 1e-6);
    const double mean = r_of_case.tallies[1].axes.at(0).mean.at(0);
    EXPECT_NEAR(std::remainder(mean - std::atan2(c.along.y, c.along.x), 2 * std::numbers::pi), 0, 1e-6);
  }
}

TEST(SpinAngles, HaveTheMeanDirectionAndNotTheMeanNumberAcrossHalfATurn) {
  const auto group = [](std::vector<double> angles) {
    MomentSums m;
    for (const double a : angles) {
      m.q += 1;
      m.qu += static_cast<Sum>((1 + std::cos(a)) * moment_steps / 2);
      m.quu += static_cast<Sum>((1 + std::sin(a)) * moment_steps / 2);
    }
    return m;
  };
  const double pi = std::numbers::pi;
  const MeanAndDeviation m = direction_of({group({pi - 0.2, -pi + 0.1}), group({-pi + 0.2, pi - 0.1})});
  EXPECT_NEAR(std::abs(m.mean), pi, 1e-6);
  // For small angles a: the root of their mean square, and its error in the mean from two groups of -0.05,
  // 0.05.
  EXPECT_NEAR(m.deviation, std::sqrt((0.04 + 0.01) / 2), 1e-3);
  EXPECT_NEAR(m.mean_error, std::sqrt(2 * 2 * 0.1 * 0.1) / 4, 2e-3);
  EXPECT_TRUE(std::isnan(direction_of({MomentSums{}}).mean));
}

}  // namespace
}  // namespace rabiline::sights_test
