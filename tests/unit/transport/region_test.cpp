// Regions that turn the velocity: edges, walls, planes inside, particles that turn back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "constants.hpp"
#include "physics/suggested.hpp"
#include "simulation/trace.hpp"

namespace rabiline::region_test {
namespace {

using test::place;
using test::run_points;
using test::suggested;

/// A neutron of 1000 m/s in 1 mT circles with R = 5.457 mm under closure larmor, towards -x.
constexpr double radius = 1000 / (-test::gamma_n * 1e-3);

Beamline circle(double length) {
  Beamline b = suggested(291e3);
  b.law = DoradoLaw{Closure::larmor, 1};
  b.source = {SingleSpeed{1000}, Rectangle{0, 0}, ParallelDirection{}};
  b.chamber.reset();
  b.particles = 16;
  b.parts = {place("B", 0.1, UniformField{length, 1e-3, {}}),
             place("screen", 1.2, Detector{Rectangle{4, 4}, {1, 1}, {}})};
  return b;
}
double particles_of(const Result& r, const std::string& fate, const std::string& where = "") {
  for (const FateResult& f : r.fates)
    if (f.fate == fate && (where.empty() || f.where == where)) return f.particles.at(0);
  return -1;
}

TEST(Region, LetsAParticleOutAtItsEndOnTheCircleItFlew) {
  const double length = 0.5 * radius;
  const Track t = trace(circle(length), 0, best_isa());
  EXPECT_EQ(t.fate, "detected");
  std::size_t out = 0;
  while (t.y[out] < 0.1 + length) ++out;
  EXPECT_EQ(t.y[out], 0.1 + length);
  EXPECT_NEAR(t.x[out], -radius * (1 - std::sqrt(0.75)), 1e-12);
  EXPECT_NEAR(t.vx[out], -500, 1e-8);
}

TEST(Region, StopsAtItsBoreOrTheChamberAndSaysWhich) {
  Beamline b = circle(0.1);
  b.chamber = Chamber{8e-3};
  EXPECT_EQ(particles_of(run_points({b}), "stopped", "chamber"), 16);
  std::get<UniformField>(b.parts[0].part).bore = Bore{4e-3};
  EXPECT_EQ(particles_of(run_points({b}), "stopped", "B"), 16);
}

TEST(Region, CatchesAtAScreenInsideItWhatComesBackToo) {
  // The screen stands in the half plane of the circle's second quarter, so it is hit from behind.
  Beamline b = circle(0.1);
  Detector inner{Rectangle{2e-3, 4e-3}, {4, 1}, {-2 * radius + radius * (1 - std::sqrt(0.75)), 0}};
  b.parts.insert(b.parts.begin() + 1, place("inner", 0.1 + 0.5 * radius, inner));
  const Result r = run_points({b});
  EXPECT_EQ(r.detectors.at(0).detected.at(0), 1);
  EXPECT_EQ(particles_of(r, "detected", "inner"), 16);
  EXPECT_EQ(r.detectors[0].counts_x[0] + r.detectors[0].counts_x[3], 0);
}

TEST(Region, StopsAtASlitInsideItWhatMissesTheOpening) {
  Beamline b = circle(0.1);
  b.parts.insert(b.parts.begin() + 1, place("S", 0.1 + 0.5 * radius, Slit{Disc{0.1e-3}, {}}));
  EXPECT_EQ(particles_of(run_points({b}), "stopped", "S"), 16);
  std::get<Slit>(b.parts[1].part).offset.x = -radius * (1 - std::sqrt(0.75));
  EXPECT_EQ(particles_of(run_points({b}), "stopped", "S"), 16);  // through once, but not on the way back
}

TEST(Region, StopsAtTheNarrowerOfTwoSlitsAtOnePlaceInsideIt) {
  Beamline b = circle(0.1);
  b.parts.insert(b.parts.begin() + 1, place("wide", 0.1 + 0.5 * radius, Slit{Disc{4e-3}, {}}));
  b.parts.insert(b.parts.begin() + 2, place("narrow", 0.1 + 0.5 * radius, Slit{Disc{0.1e-3}, {}}));
  EXPECT_EQ(particles_of(run_points({b}), "stopped", "narrow"), 16);
}

TEST(Region, AlignsAtAPolarizerThatTouchesTheField) {
  // B' and B as one field: unaligned spins would turn the path under torque, aligned ones fly straight.
  Beamline b = suggested(291e3);
  b.chamber.reset();
  b.parts = {place("before", 0.05, UniformField{0.05, 5e-5, {}}),
             place("P", 0.1, test::suggested(1).parts[0].part),
             place("screen", 1.2, Detector{Rectangle{1, 1}, {1, 1}, {}})};
  const Track t = trace(b, 0, best_isa());
  ASSERT_EQ(t.fate, "detected");
  std::size_t end = t.y.size() - 1;
  EXPECT_GT(std::abs(t.vx[end]), 1);  // the path did turn before
  EXPECT_NEAR(t.sz[end], -1, 1e-12);
  std::size_t in = 0;
  while (t.y[in] < 0.1001) ++in;
  EXPECT_NEAR(t.vx[end], t.vx[in], 1e-9);
}

/// A chord of 60 degrees of the circle within a channel that is turned about the beam: paths bulge out of its
/// ends by 0.7 mm.
Beamline chord(const Rectangle& channel) {
  Beamline b = circle(radius);
  const double slope = std::tan(std::numbers::pi / 6);
  b.source.opening = Rectangle{0.3e-3, 0.3e-3};
  b.source.direction = BoxDirection{3e-3, 3e-3};
  b.source.tilt.z = -std::numbers::pi / 6;
  b.source.offset.x = -0.1 * slope;
  b.parts.insert(b.parts.begin() + 1, place("channel", 0.1, Collimator{radius, channel, {}, {0.3}}));
  return b;
}
/// By how much a particle of that beam comes beyond the walls [m], on a circle by points of its path.
double beyond_walls(const Track& t, const Rectangle& channel) {
  const double rate = 1000 / radius;
  const double to_field = 0.1 / t.vy[0], x0 = t.x[0] + t.vx[0] * to_field, z0 = t.z[0] + t.vz[0] * to_field;
  double worst = -1;
  for (double angle = 0;; angle += 1e-4) {
    const double c = std::cos(angle), s = std::sin(angle);
    const double y = (t.vy[0] * s + t.vx[0] * (1 - c)) / rate, time = angle / rate;
    const double x = x0 + (t.vx[0] * s - t.vy[0] * (1 - c)) / rate, z = z0 + t.vz[0] * time;
    if (y > radius) return worst;
    const double u = x * std::cos(0.3) - z * std::sin(0.3), v = x * std::sin(0.3) + z * std::cos(0.3);
    worst = std::max({worst, std::abs(u) - channel.width / 2, std::abs(v) - channel.height / 2});
  }
}
TEST(Region, StopsInARectangularChannelWhatTouchesItsWallsBetweenItsEnds) {
  const Rectangle channel{1.4e-3, 1.2e-3};
  for (const bool in_steps : {false, true}) {
    Beamline b = chord(channel);
    if (in_steps) b.gravity = Gravity{1e-3, {0, 0, -1}};
    b.particles = 200;
    int stopped = 0;
    for (std::uint64_t particle = 0; particle < b.particles; ++particle) {
      const Track t = trace(b, particle, best_isa());
      const double beyond = beyond_walls(t, channel);
      if (std::abs(beyond) < 1e-7) continue;
      EXPECT_EQ(t.fate, beyond > 0 ? "stopped" : "detected") << particle << ' ' << beyond << ' ' << in_steps;
      if (beyond > 0) {
        EXPECT_EQ(t.where, "channel");
      }
      stopped += beyond > 0 ? 1 : 0;
    }
    EXPECT_GT(stopped, 40);
    EXPECT_LT(stopped, 160);
  }
}

TEST(Region, OfNoFieldFliesStraight) {
  Beamline b = circle(0.3);
  std::get<UniformField>(b.parts[0].part).field = 0;
  EXPECT_EQ(trace(b, 0, best_isa()).x.back(), 0);
}

}  // namespace
}  // namespace rabiline::region_test
