// Levels of atoms by the amplitudes that a run carries, and by both spins in the laboratory, step by step.
#include "simulation/level_check.hpp"

#include <gtest/gtest.h>

#include "unit/transport/level_laboratory.hpp"

namespace rabiline::level_check_test {
namespace {

/// Of the first particle of a flight.
std::vector<double> referred(const Flight& f, int level, double operations = 1e10) {
  const LevelWay way(f.fields, table_of(f));
  const RandomKey key{};
  const auto found = LevelReference(way, key).carried(
      {{0, f.length, 0}, {0, f.speed, 0}, f.length / f.speed, {}, 0, level}, operations);
  return found ? *found : std::vector<double>{};
}
Flight past_zero(const CoupledSpins& spins) {
  return flight(spins, 800, 0.02, linear(20e-6, 2e-6, 0, 0, 0.003, 0.2), 0.011);
}

TEST(LevelReference, IsWhatIsCarriedPastAZeroOfTheFieldAndWouldNotBeIfAFieldWereAnother) {
  for (const char* atom : {"K-39 atom", "ortho-H2"}) {
    Flight f = past_zero(of(atom));
    if (f.spins.twice_j > 1) f.apart = 1e8;
    const std::vector<double> p = carried(f, 1);
    EXPECT_LT(worst_difference(p, referred(f, 1)), 1e-6) << atom;
    f.fields.shaped[0].linear.field[0] *= 1.01;
    EXPECT_GT(worst_difference(p, referred(f, 1)), 5e-5) << atom;
  }
}

/// 0.5 mT along x and further on 1.4 mT between x and z, or the other way round; no field at the ends.
Flight through_two_fields(bool opposite) {
  Flight f = flight(of("ortho-H2"), 1000, 0.01, linear(0.5e-3, 0, 0, 0, 0, 0), 0);
  f.apart = 1e8;
  const double side = opposite ? -1 : 1;
  f.fields.shaped.push_back(ShapedTerm(linear(side * 1e-3, 0, 1e-3, 0, 0, 0)));
  CourseSection second = f.fields.sections[0];
  f.fields.sections[0].field.end = second.field.begin = 0.004;
  second.shaped_begin = 1;
  second.shaped_end = 2;
  f.fields.sections.push_back(second);
  f.fields.begins_in_field = f.fields.ends_in_field = false;
  return f;
}
TEST(LevelReference, TurnsDirectionsAtOnceWhereFieldsMeet) {
  for (const bool opposite : {false, true}) {
    const Flight f = through_two_fields(opposite);
    const std::vector<double> p = carried(f, 2);
    EXPECT_LT(worst_difference(p, referred(f, 2)), 1e-6) << opposite;
    EXPECT_LT(p[2], 0.9) << opposite;
  }
}

TEST(LevelReference, FollowsPulsesOfADrive) {
  Flight f = flight(of("K-39 atom"), 800, 0.012, linear(0.02e-3, 0, 0.2857e-3, 0, 0, 0.004), 0.006);
  f.apart = 1e8;
  CourseSection& section = f.fields.sections[0];
  DriveTerm& drive = section.field.drive[0];
  section.field.drives = 1;
  drive.spin_rate = 12e-6;
  drive.omega = two_pi * 2e6;
  drive.gate = {2.1e-6, 3.7e-6, 4.3e-6, 3};
  section.fastest = drive.omega;
  section.is_pulsed = true;
  const std::vector<double> p = carried(f, 0);
  EXPECT_LT(worst_difference(p, referred(f, 0)), 1e-6);
  EXPECT_LT(p[0], 0.95);
}

TEST(LevelReference, SaysNothingWhereItWouldTakeTooLong) {
  EXPECT_TRUE(referred(past_zero(of("Cs-133 atom")), 1, 1e6).empty());
}

}  // namespace
}  // namespace rabiline::level_check_test
