// Scan points between few frequencies, against the same points flown alone.
#include <gtest/gtest.h>

#include "apparatus.hpp"
#include "as_alone.hpp"
#include "physics/atoms.hpp"

namespace rabiline::test::interpolation_test {
namespace {

/// Between two magnets that part levels, one zone or two of them on one oscillator.
struct Clock {
  std::string species = "Cs-133 atom";
  double c_field = 6e-6, centre = 9192631771.5, width = 1000;  // [T], [Hz]
  double amplitude = 0.46e-6, zone = 0.01, way = 1.0;          // [T], [m]
  bool turns = false;                                          // across z, else along it
  DriveProfile profile{};
  double temperature = 370;
  std::uint64_t particles = 30000;

  template <class Drive>
  void add_drives(Drive drive, double frequency, Beamline& b) const {
    drive.length = zone;
    drive.amplitude = amplitude;
    drive.profile = profile;
    Drive second = drive;
    drive.frequency = frequency;
    drive.phase = {Phase::Kind::random, 0};
    b.parts.push_back(place("first", 0.4, drive));
    if (way == 0) return;
    second.oscillator = "first";
    second.phase = {Phase::Kind::locked, 0.3};
    b.parts.push_back(place("second", 0.4 + way, second));
  }

  Beamline at(double frequency) const {
    Beamline b = suggested(0);
    b.law = QuantumLaw{Outcomes::split};
    b.species = {{*find_species(species), 1}};
    b.source = {EffusiveSpeed{temperature}, Rectangle{2e-3, 40e-6}, BoxDirection{0.5e-3, 20e-6}};
    b.chamber.reset();
    b.parts = {place("A", 0.1, gradient_magnet(0.1, 1, 15)),
               place("C", 0.3, UniformField{way + 0.2, c_field, {}})};
    if (turns) {
      add_drives(turning(zone, amplitude, frequency, Sense::positive), frequency, b);
    } else {
      OscillatingField drive = swinging(zone, amplitude, {});
      drive.direction = {0, 0, 1};
      drive.approximation = Approximation::rotating_wave;
      add_drives(drive, frequency, b);
    }
    Monitor monitor{Disc{50e-3}, {}};
    monitor.tallies = {{"levels", {levels_of(Quantity::prepared_level), levels_of(Quantity::level)}},
                       {"speeds", {axis(Quantity::speed, 100, 600, 4)}}};
    Detector detector{Rectangle{10e-3, 0.6e-3}, {2, 9}, {}};
    detector.efficiency = 2.0 / 3;
    detector.dead = DeadArea{Rectangle{10e-3, 0.02e-3}, {}};
    b.parts.push_back(place("B", way + 0.6, gradient_magnet(0.1, 1, 105)));
    b.parts.push_back(place("look", way + 0.8, monitor));
    b.parts.push_back(place("screen", way + 0.9, detector));
    b.particles = particles;
    return b;
  }
  std::vector<Beamline> scan(int points) const {
    std::vector<Beamline> out;
    for (int i = 0; i < points; ++i) out.push_back(at(centre + width * (i / (points - 1.0) - 0.5)));
    return out;
  }
};

const std::vector<SlownessClass>& classes_in(const std::vector<PlanNode>& nodes) {
  for (const PlanNode& node : nodes) {
    if (!node.classes.empty() || node.next.empty()) return node.classes;
    if (!classes_in(node.next).empty()) return classes_in(node.next);
  }
  return nodes.front().classes;
}
const std::vector<SlownessClass>& classes_in(const Plan& plan) { return classes_in(plan.trees.front().next); }

TEST(FewFrequencies, GiveEachPointOfAClockAsIfItWereFlownAlone) {
  const std::vector<Beamline> scan = Clock{}.scan(101);
  const Plan plan = plan_of(scan);
  ASSERT_GT(classes_in(plan).size(), 1U);
  // Some atoms are too slow for all of them.
  ASSERT_LT(classes_in(plan).back().last, 1.0 / 90);
  expect_points_as_alone(scan, plan, 14);
}
TEST(FewFrequencies, GiveZonesWhoseSizeRunsAlongTheBeam) {
  Clock clock{.particles = 8000};
  clock.profile = HalfSineProfile{};
  const std::vector<Beamline> scan = clock.scan(201);
  const Plan plan = plan_of(scan);
  ASSERT_FALSE(classes_in(plan).empty());
  expect_points_as_alone(scan, plan, 50);
}
/// Levels that are up to four photons apart.
TEST(FewFrequencies, GiveTransitionsOverManyLevelsInAFieldThatTurns) {
  Clock clock{.species = "Na-23 atom", .c_field = 1e-4, .centre = 0.7e6, .width = 20e3};
  clock.amplitude = 2e-6;
  clock.zone = 0.05;
  clock.way = 0;
  clock.turns = true;
  clock.temperature = 500;
  const std::vector<Beamline> scan = clock.scan(201);
  const Plan plan = plan_of(scan);
  ASSERT_FALSE(classes_in(plan).empty());
  expect_points_as_alone(scan, plan, 40);
}
TEST(FewFrequencies, ServeEachAmplitudeOfAGrid) {
  Clock clock;
  std::vector<Beamline> scan;
  for (const double amplitude : {0.3e-6, 0.5e-6, 0.7e-6}) {
    clock.amplitude = amplitude;
    for (const Beamline& b : clock.scan(101)) scan.push_back(b);
  }
  const Plan plan = plan_of(scan);
  ASSERT_FALSE(classes_in(plan).empty());
  EXPECT_EQ(classes_in(plan).front().families.size(), 3U);
  expect_points_as_alone(scan, plan, 61);
}
TEST(FewFrequencies, TellHowPointsVaryTogether) {
  const std::vector<Beamline> scan = Clock{}.scan(101), some{scan[20], scan[51], scan[88]};
  const Plan plan = plan_of(scan), of_some = plan_of(some);
  ASSERT_FALSE(classes_in(plan).empty());
  ASSERT_TRUE(classes_in(of_some).empty());
  const Result all = flown(scan, plan), one_by_one = flown(some, of_some);
  const std::size_t number[] = {20, 51, 88};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const double scale =
          all.detectors[0].detected_errors[number[i]] * all.detectors[0].detected_errors[number[j]];
      EXPECT_NEAR(all.detectors[0].detected_covariance[number[i] * 101 + number[j]],
                  one_by_one.detectors[0].detected_covariance[i * 3 + j], 1e-6 * scale);
    }
}
TEST(FewFrequencies, GiveTheSameBitsForAnyThreadsBatchesAndInstructionSets) {
  const std::vector<Beamline> scan = Clock{}.scan(101);
  expect_same_bits(scan, plan_of(scan));
}
/// Bins have some quanta each, and interpolation leaves less than nothing in some of them.
TEST(FewFrequencies, AddUpWhereHardlyAnAtomChangesItsLevel) {
  Clock clock{.amplitude = 1e-12};
  const std::vector<Beamline> scan = clock.scan(101);
  const Plan plan = plan_of(scan);
  ASSERT_FALSE(classes_in(plan).empty());
  expect_points_as_alone(scan, plan, 50);
}
/// Neither has another scan parameter, nor are there too few points for it.
TEST(FewFrequencies, ServeScansOfAFrequencyAloneWhereTheyAreFewer) {
  EXPECT_TRUE(classes_in(plan_of(Clock{}.scan(21))).empty());
  std::vector<Beamline> fields;
  for (int i = 0; i < 101; ++i) fields.push_back(Clock{.c_field = 6e-6 + 1e-9 * i}.at(9192631771.5));
  EXPECT_TRUE(classes_in(plan_of(fields)).empty());
  EXPECT_TRUE(classes_in(plan_of(Clock{.particles = 10}.scan(101))).empty());
}
/// A field that swings at a frequency that is not large against its own strength: what the rotating-wave
/// approximation leaves out depends on the frequency otherwise than phases do. So it is looked at.
TEST(FewFrequencies, AreNotTakenWhereShiftsDependOnTheFrequencyToo) {
  Clock clock{.species = "Na-23 atom", .c_field = 1e-6, .centre = 7.5e3, .width = 14.9e3};
  clock.amplitude = 1e-6;
  clock.zone = 0.05;
  clock.way = 0;
  clock.temperature = 500;
  std::vector<Beamline> scan = clock.scan(201);
  for (Beamline& b : scan) std::get<OscillatingField>(b.parts[2].part).direction = {1, 0, 0};
  EXPECT_TRUE(classes_in(plan_of(scan)).empty());
}

}  // namespace
}  // namespace rabiline::test::interpolation_test
