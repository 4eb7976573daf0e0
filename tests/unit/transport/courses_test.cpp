// Closed forms and slow steps of a region, by themselves: their order, their limits, and that another course
// gives the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plan/courses.hpp"
#include "transport/stages/turning_region.hpp"

namespace rabiline::courses_test {
namespace {

constexpr double w0 = 1.83e6, stay = 2e-4;  // [rad/s], [s] at 1000 m/s
constexpr double turn = 2 * std::numbers::pi / w0;

/// One field that rotates off resonance by `detuned`, closure torque with kappa = 1.
RegionZone zone_of(double w1, double detuned) {
  RegionZone zone;
  zone.field.begin = 0.1;
  zone.field.end = 0.3;
  zone.field.spin_rate = zone.field.turn_rate = w0;
  zone.field.kind = ZoneKind::rotating;
  zone.field.drives = 1;
  zone.field.drive[0].spin_rate = zone.field.drive[0].turn_rate = w1;
  zone.field.drive[0].omega = w0 + detuned;
  zone.field.drive[0].phase = 0.4;
  zone.wall_radius = 1;
  zone.step = turn / 500;
  return zone;
}
/// The static field alone.
SpinZone uniform(SpinZone field) {
  field.drives = 0;
  field.kind = ZoneKind::precession;
  return field;
}
RegionZone along(RegionZone zone, ZoneCourse course, double span) {
  zone.course = course;
  zone.table = span_table(zone.field, span, course);
  return zone;
}

/// Eight particles of 1000 m/s and as many directions, which come out of the zone's end.
Batch flown(const RegionZone& zone, bool take_off, double tilt = 0) {
  TurningRegion region;
  region.zones = {zone};
  region.take_off_spin_component = take_off;
  region.most_way = 40;
  Batch batch;
  BatchView& v = batch.view();
  v.count = v.padded = 8;
  v.y = 0.1;
  for (int i = 0; i < 8; ++i) {
    v.x[i] = v.z[i] = 0;
    v.vx[i] = 20 * i;
    v.vz[i] = -10 * i;
    v.vy[i] = std::sqrt(1e6 - v.vx[i] * v.vx[i] - v.vz[i] * v.vz[i]);
    v.slowness[i] = 1 / v.vy[i];
    v.t[i] = 1e-4 * i;
    v.sx[i] = std::sin(tilt);
    v.sy[i] = 0;
    v.sz[i] = (i % 2 == 0 ? -1 : 1) * std::cos(tilt);
    v.level[i] = v.prepared[i] = v.caught_by[i] = v.scratch[i] = 0;
    v.weight[i] = 1;
    v.particle[i] = static_cast<std::uint64_t>(i);
    v.flying[i] = ~std::uint64_t{0};
  }
  std::vector<Sum> sums(region.sums());
  StageContext context{best_isa(), {}, batch, sums.data()};
  region.pass(context);
  for (int i = 0; i < 8; ++i) EXPECT_NE(v.flying[i], 0);
  return batch;
}

/// Of place over the way, and of direction.
double difference(Batch& a, Batch& b) {
  const BatchView &p = a.view(), &q = b.view();
  double most = 0;
  for (int i = 0; i < 8; ++i)
    most = std::max({most, std::abs(p.x[i] - q.x[i]) / 0.2, std::abs(p.z[i] - q.z[i]) / 0.2,
                     std::abs(p.t[i] - q.t[i]) / stay, std::abs(p.vx[i] - q.vx[i]) / 1000,
                     std::abs(p.vz[i] - q.vz[i]) / 1000, std::abs(p.sx[i] - q.sx[i])});
  return most;
}

TEST(JointTurns, AgreeWithFineStepsAndFallWithTheSixthPowerOfTheirSpansOrFaster) {
  const RegionZone zone = zone_of(500, 8000);
  Batch fine = flown(along(zone, ZoneCourse::joint_turns, turn / 12), true), steps = flown(zone, true);
  EXPECT_LT(difference(fine, steps), 1e-9);
  double last = 1;
  for (const double spans_per_turn : {1.0, 2.0, 4.0}) {
    Batch now = flown(along(zone, ZoneCourse::joint_turns, turn / spans_per_turn), true);
    const double error = difference(now, fine);
    EXPECT_LT(error, 5e-5 / std::pow(spans_per_turn, 6)) << spans_per_turn;
    EXPECT_LT(error, last);
    last = error;
  }
  Batch wrong = flown(along(zone_of(505, 8000), ZoneCourse::joint_turns, turn / 4), true);
  EXPECT_GT(difference(wrong, fine), 1e-5) << "1 % of the rotating field must show";
}

TEST(SlowTurns, AgreeWithFineStepsAndFallWithTheFifthPowerOfTheirSpansOrFaster) {
  for (const double detuned : {0.0, 3e4, -1.2e5}) {
    const RegionZone zone = zone_of(300, detuned);
    Batch fine = flown(along(zone, ZoneCourse::joint_turns, turn / 12), true);
    double first = 0;
    for (const double spans : {4.0, 8.0, 16.0}) {
      Batch now = flown(along(zone, ZoneCourse::slow_turns, 1.05 * stay / spans), true);
      const double error = difference(now, fine);
      if (first == 0) first = error;
      EXPECT_LT(error, 2e-6 * std::pow(4 / spans, 5) + 1e-11) << detuned << ", " << spans;
    }
    Batch wrong = flown(along(zone_of(303, detuned), ZoneCourse::slow_turns, stay / 16), true);
    EXPECT_GT(difference(wrong, fine), detuned == 0 ? 1e-5 : 1e-8) << "1 % of the rotating field must show";
  }
}

TEST(SlowTurns, AgreeWithFineStepsForOtherStrengths) {
  for (const double kappa : {-1.2, 0.4, 1.7})
    for (const double detuned : {0.0, 3e4}) {
      RegionZone zone = zone_of(100, detuned);
      zone.field.turn_rate *= kappa;
      zone.field.drive[0].turn_rate *= kappa;
      Batch steps = flown(zone, true);
      double last = 1;
      for (const double spans : {2.0, 4.0, 8.0}) {
        Batch now = flown(along(zone, ZoneCourse::slow_turns, 1.05 * stay / spans), true);
        const double error = difference(now, steps);
        EXPECT_LT(error, std::max(0.2 * last, 2e-9)) << kappa << ", " << detuned << ", " << spans;
        last = error;
      }
      EXPECT_LT(last, 1e-7) << kappa << ", " << detuned;
      zone.field.turn_rate *= 1.01;
      Batch wrong = flown(along(zone, ZoneCourse::slow_turns, stay / 8), true);
      EXPECT_GT(difference(wrong, steps), 1e-7) << "1 % of kappa must show";
    }
}

TEST(Courses, WithoutAFieldOrADriveFlyStraight) {
  for (const ZoneCourse course : {ZoneCourse::joint_turns, ZoneCourse::slow_turns, ZoneCourse::constant}) {
    RegionZone zone = zone_of(0, 0);  // on resonance: nothing turns in the frame of the field
    if (course == ZoneCourse::constant) zone.field = uniform(zone.field);
    Batch batch = flown(along(zone, course, course == ZoneCourse::joint_turns ? turn / 2 : stay), true);
    for (int i = 0; i < 8; ++i) {
      const BatchView& v = batch.view();
      const double vy = std::sqrt(1e6 - 500.0 * i * i);
      EXPECT_NEAR(v.x[i], 0.2 * 20 * i / vy, 1e-12);
      EXPECT_NEAR(v.t[i], 1e-4 * i + 0.2 / vy, 1e-15);
      EXPECT_NEAR(v.vz[i], -10 * i, 1e-9);
    }
  }
  RegionZone zone = zone_of(0, 0);
  zone.field.drives = 0;
  zone.field.kind = ZoneKind::precession;
  zone.field.spin_rate = zone.field.turn_rate = 0;
  Batch batch = flown(along(zone, ZoneCourse::constant, stay), false, 0.4);
  EXPECT_EQ(batch.view().x[0], 0);
  EXPECT_NEAR(batch.view().sx[3], std::sin(0.4), 1e-15);
}

/// In a uniform field alone, v turns about it by W t, S by w t, and under torque W keeps its angle to S.
TEST(ConstantTurn, AgreesWithFineStepsForBothClosuresInARotatingFieldAndWithout) {
  for (const bool take_off : {false, true}) {
    RegionZone zone = zone_of(900, 4000);
    zone.field.turn_rate = 5e-4 * w0;
    zone.field.drive[0].turn_rate = 5e-4 * 900;
    if (take_off) zone.field = uniform(zone.field);
    Batch steps = flown(zone, take_off, 0.5);
    Batch closed = flown(along(zone, ZoneCourse::constant, 4 * stay), take_off, 0.5);
    EXPECT_LT(difference(steps, closed), 1e-10) << take_off;
    zone.field.turn_rate *= 1.01;
    Batch wrong = flown(along(zone, ZoneCourse::constant, 4 * stay), take_off, 0.5);
    EXPECT_GT(difference(wrong, closed), 1e-5) << "1 % of the turning must show";
  }
}

}  // namespace
}  // namespace rabiline::courses_test
