// Levels of atoms through fields of any direction, against Schroedinger's equation of both spins in the
// laboratory, and closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "spin/majorana.hpp"
#include "unit/transport/level_laboratory.hpp"

namespace rabiline::level_way_test {
namespace {

/// Past a zero of the field, some of it across, at a speed at which levels neither stay nor follow.
Flight past_zero(const CoupledSpins& spins) {
  return flight(spins, 800, 0.02, linear(20e-6, 2e-6, 0, 0, 0.003, 0.2), 0.011);
}

/// A field along x that swings all along the way, its size [T] and frequency [Hz].
void swing(Flight& f, double field, double frequency) {
  CourseSection& section = f.fields.sections[0];
  DriveTerm& drive = section.field.drive[0];
  section.field.drives = 1;
  drive.spin_rate = field;
  drive.omega = two_pi * frequency;
  drive.second[1] = 0;
  drive.in_xy = false;
  section.fastest = drive.omega;
}

/// A field that differs from place to place and swings as cos(2 pi f t + 0.4).
void swing(Flight& f, ShapedTerm term, double frequency) {
  CourseSection& section = f.fields.sections[0];
  term.drive = section.field.drives++;
  DriveTerm& drive = section.field.drive[term.drive];
  drive.omega = two_pi * frequency;
  drive.phase = 0.4;
  section.fastest = drive.omega;
  section.shaped_end = 2;
  f.fields.shaped.push_back(term);
}
/// A ring about the middle of the way, whose axis is between x and y, and its field there [T].
ShapedTerm ring(const Flight& f, double field) {
  ShapedTerm term(LoopShape{0.2 * f.length, field});
  const double half = std::sqrt(0.5), axes[9] = {0, 0, 1, half, -half, 0, half, half, 0};
  term.y = f.length / 2;
  term.turned = true;
  std::ranges::copy(axes, term.axes);
  return term;
}

TEST(LevelWay, IsSchroedingersEquationPastAZeroOfTheField) {
  for (const char* atom : {"H atom", "D atom", "K-39 atom"})
    for (const int level : {0, 2}) {
      const Flight f = past_zero(of(atom));
      const std::vector<double> p = carried(f, level);
      EXPECT_LT(worst_difference(p, Laboratory(f).carried(level)), 1e-6) << atom << level;
      EXPECT_LT(p[static_cast<std::size_t>(level)], 0.9) << atom << level;
    }
}

TEST(LevelWay, IsSchroedingersEquationWhereTheFieldTurnsTheLevelsRound) {
  // From above the field of the hyperfine interaction to the other side of zero.
  const Flight f = flight(of("K-39 atom"), 1000, 0.005, linear(0.3e-3, 0, 0, 0, 0, 14), 50e-3 / 14);
  EXPECT_LT(worst_difference(carried(f, 1), Laboratory(f).carried(1)), 1e-6);
}

TEST(LevelWay, IsSchroedingersEquationOfLevelsThatAreNear) {
  Flight f = flight(of("ortho-H2"), 1500, 0.06, linear(20e-6, 0, 0, 0, 0, -0.2), 0.05);
  f.apart = 1e7;
  for (const int level : {0, 3, 8})
    EXPECT_LT(worst_difference(carried(f, level), Laboratory(f).carried(level)), 1e-6);
  Flight own = past_zero(structure(3, 3, 2e6, 0.7e6, 1.3, 1e-4));
  own.apart = 1e8;
  EXPECT_LT(worst_difference(carried(own, 1), Laboratory(own).carried(1)), 1e-6);
}

TEST(LevelWay, IsSchroedingersEquationOfAnInvertedStructureAndOfNone) {
  // An inverted one has its largest F below.
  const Flight inverted = past_zero(structure(3, 1, -150e6, 0, 2.002, 2e-4));
  EXPECT_LT(worst_difference(carried(inverted, 0), Laboratory(inverted).carried(0)), 1e-6);
  const Flight free = past_zero(structure(1, 2, 0, 0, 1.5, 1e-3));
  EXPECT_LT(worst_difference(carried(free, 0), Laboratory(free).carried(0)), 1e-6);
}

TEST(LevelWay, IsSchroedingersEquationOfAFieldThatTurnsInTime) {
  // 2 MHz about a field that crosses the resonance: an adiabatic fast passage of potassium.
  Flight f = flight(of("K-39 atom"), 800, 0.03, linear(0, 0, 0.2857e-3, 0, 0, 0.004), 0.015);
  swing(f, 8e-6, 2e6);
  f.apart = 1e8;
  const std::vector<double> p = carried(f, 0);
  EXPECT_LT(worst_difference(p, Laboratory(f).carried(0)), 1e-6);
  EXPECT_LT(p[0], 0.9);
}

/// Potassium in a field that turns, past a ring that swings with 2 MHz.
Flight past_a_ring(double field) {
  Flight f = flight(of("K-39 atom"), 800, 0.012, linear(0.02e-3, 0, 0.2857e-3, 0, 0, 0.004), 0.006);
  swing(f, ring(f, field), 2e6);
  f.apart = 1e8;
  return f;
}
TEST(LevelWay, IsSchroedingersEquationOfARingThatSwings) {
  const Flight f = past_a_ring(20e-6);
  for (const int level : {0, 3}) {
    const std::vector<double> p = carried(f, level);
    EXPECT_LT(worst_difference(p, Laboratory(f).carried(level)), 1e-6);
    EXPECT_LT(p[static_cast<std::size_t>(level)], 0.95);
    EXPECT_GT(worst_difference(p, carried(past_a_ring(20.2e-6), level)), 1e-4);  // one per cent is seen
  }
}
TEST(LevelWay, IsSchroedingersEquationOfSpinsThatAreNearInARingThatSwings) {
  Flight f =
      flight(structure(3, 3, 2e6, 0.7e6, 1.3, 1e-4), 800, 0.02, linear(20e-6, 2e-6, 0, 0, 0.003, 0.2), 0.011);
  swing(f, ring(f, 60e-6), 1.3e6);
  f.apart = 1e8;
  EXPECT_LT(worst_difference(carried(f, 1), Laboratory(f).carried(1)), 1e-6);
}
TEST(LevelWay, IsNotChangedByAFieldThatSwingsByNothing) {
  for (const int level : {0, 3}) {
    const Flight without =
        flight(of("K-39 atom"), 800, 0.012, linear(0.02e-3, 0, 0.2857e-3, 0, 0, 0.004), 0.006);
    EXPECT_LT(worst_difference(carried(past_a_ring(0), level), carried(without, level)), 1e-8);
  }
}
/// One spin in a field that swings with its Larmor frequency, half of which turns with the spin: a flip in
/// h/(g mu_B b), but for (b/B)^2, since levels are those along the whole field (I. I. Rabi, Phys. Rev. 51,
/// 652 (1937)).
TEST(LevelWay, IsFlippedByAFieldThatSwingsWithTheFrequencyOfALine) {
  constexpr double field = 20e-6, across = 0.05e-6;
  const CoupledSpins spin = structure(0, 1, 0, 0, 2, 0);
  Flight f = flight(spin, 1000, 1000 / (spin.zeeman_j * across), linear(0, 0, field, 0, 0, 0), 0);
  swing(f, ShapedTerm(linear(across, 0, 0, 0, 0, 0)), spin.zeeman_j * field);
  EXPECT_NEAR(carried(f, 0)[1], 1, (across / field) * (across / field));
}
/// 5,000 periods later all is the same, though a time has its last digits elsewhere.
TEST(LevelWay, IsDrivenLongAfterEmissionAsAtOnce) {
  const CoupledSpins spin = structure(0, 1, 0, 0, 2, 0);
  Flight f = flight(spin, 1000, 0.02, linear(0, 0, 17e6 / spin.zeeman_j, 0, 0, 0), 0);
  swing(f, 300e-6, 17e6);
  const std::vector<double> at_once = carried(f, 0);
  f.fields.sections[0].field.begin = 0.3;
  f.fields.sections[0].field.end = f.length = 0.32;
  EXPECT_LT(worst_difference(carried(f, 0), at_once), 5e-8);
  EXPECT_LT(at_once[0], 0.9);
  EXPECT_GT(at_once[0], 0.1);
}
/// Where nothing stands the spin turns about the one axis, by 2 pi (g mu_B/h) b (sin(wt + p) - sin p)/w.
TEST(LevelWay, TurnsAboutAFieldThatSwingsAlone) {
  Flight f = flight(structure(0, 1, 0, 0, 2, 0), 1000, 0.05, linear(0, 0, 0, 0, 0, 0), 0);
  f.fields.begins_in_field = f.fields.ends_in_field = false;
  swing(f, ShapedTerm(linear(3e-6, 0, 0, 0, 0, 0)), 37e3);
  const double w = two_pi * 37e3, angle = two_pi * f.spins.zeeman_j * 3e-6 *
                                          (std::sin(w * f.length / f.speed + 0.4) - std::sin(0.4)) / w;
  EXPECT_NEAR(carried(f, 0)[0], std::pow(std::cos(angle / 2), 2), 1e-8);
  EXPECT_LT(std::pow(std::cos(angle / 2), 2), 0.9);
}
TEST(LevelWay, NamesAParticleThatItCannotFollow) {
  Flight f = past_a_ring(20e-6);
  f.fields.shaped[1].loop.field = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(
      {
        try {
          carried(f, 0);
        } catch (const std::invalid_argument& lost) {
          EXPECT_NE(std::string(lost.what()).find("could not be followed"), std::string::npos);
          throw;
        }
      },
      std::invalid_argument);
}

/// Potassium in a field that turns, and three pulses of 2 MHz of a microsecond and a half.
Flight in_pulses() {
  Flight f = flight(of("K-39 atom"), 800, 0.012, linear(0.02e-3, 0, 0.2857e-3, 0, 0, 0.004), 0.006);
  swing(f, 12e-6, 2e6);
  f.fields.sections[0].is_pulsed = true;
  f.fields.sections[0].field.drive[0].gate = {2.1e-6, 3.7e-6, 4.3e-6, 3};
  f.apart = 1e8;
  return f;
}
TEST(LevelWay, IsSchroedingersEquationOfPulses) {
  const Flight f = in_pulses();
  for (const int level : {0, 3}) {
    const std::vector<double> p = carried(f, level);
    EXPECT_LT(worst_difference(p, Laboratory(f).carried(level)), 1e-6);
    EXPECT_LT(p[static_cast<std::size_t>(level)], 0.95);
  }
  Flight later = f;
  later.fields.sections[0].field.drive[0].gate.end += 0.02e-6;
  EXPECT_GT(worst_difference(carried(f, 0), carried(later, 0)), 1e-4);
}
TEST(LevelWay, IsSchroedingersEquationOfAStrongFieldThatSwingsSlowly) {
  for (const double frequency : {300e3, 3e6}) {
    Flight f = flight(of("H atom"), 2000, 0.01, linear(0, 0, 20e-3, 0, 0, 0), 0);
    swing(f, 15e-3, frequency);
    // Switched at once while it is strong, so that levels interfere behind it.
    f.fields.sections[0].is_pulsed = true;
    f.fields.sections[0].field.drive[0].gate = {0.1e-6, 4.6e-6, 0, 1};
    f.apart = 3e9;
    for (const int level : {0, 1, 3})
      EXPECT_LT(worst_difference(carried(f, level), Laboratory(f).carried(level)), 1e-6)
          << frequency << ' ' << level;
  }
}
TEST(LevelWay, IsSchroedingersEquationOfAFieldAcrossThatIsThereForAMoment) {
  // Of no frequency; F that are near are mixed as it is switched.
  Flight f = flight(structure(3, 1, 2e6, 0, 2.002, 2e-4), 1000, 0.02, linear(0, 0, 40e-6, 0, 0, 0), 0);
  swing(f, 60e-6, 0);
  f.fields.sections[0].is_pulsed = true;
  f.fields.sections[0].fastest = 1e6;
  f.fields.sections[0].field.drive[0].gate = {4e-6, 5.1e-6, 0, 1};
  f.apart = 1e8;
  const std::vector<double> p = carried(f, 1);
  EXPECT_LT(worst_difference(p, Laboratory(f).carried(1)), 1e-6);
  EXPECT_LT(p[1], 0.9);
}
TEST(LevelWay, IsSchroedingersEquationWhereAFieldJumpsToOneThatUncouplesTheSpins) {
  for (const double field : {0.2e-6, 20e-6, 83e-6}) {
    Flight f = flight(structure(2, 2, 3e5, 1e5, 0.5, -0.3), 300, 0.02,
                      linear(0.34 * field, 0.87 * field, 0.36 * field, 0, 0, 0), 0);
    swing(f, 0.5e-3, 0);
    f.fields.sections[0].is_pulsed = true;
    f.fields.sections[0].fastest = 1e6;
    f.fields.sections[0].field.drive[0].gate = {10e-6, 31e-6, 0, 1};
    f.apart = 1e9;
    for (const int level : {0, 4, 8})
      EXPECT_LT(worst_difference(carried(f, level), Laboratory(f).carried(level)), 1e-6) << field;
  }
}
TEST(LevelWay, SwitchesPulsesForEachParticleWhereItIsThen) {
  const Flight f = in_pulses();
  Flight faster = f;
  faster.speed *= 1.03;
  const std::vector<double> all = all_carried(f, 0, best_isa()), alone = carried(faster, 0);
  for (std::size_t level = 0; level < alone.size(); ++level)
    EXPECT_EQ(all[level * beam_size + 3], alone[level]);
  EXPECT_GT(worst_difference(carried(f, 0), alone), 1e-3);
}

TEST(LevelWay, IsShiftedByTheOtherFThatADriveMixesIn) {
  // Potassium at 30 G and 18.4 MHz, near a line of F=2, for ten Rabi periods; F=1 is left to second order.
  Flight f = flight(of("K-39 atom"), 1000, 0.02, linear(0, 0, 3e-3, 0, 0, 0), 0);
  swing(f, 60e-6, 18.4e6);
  const std::vector<double> expected = Laboratory(f).carried(1), p = carried(f, 1);
  EXPECT_LT(worst_difference(p, expected), 5e-6);
  EXPECT_LT(p[1], 0.9);
  f.apart = 1e9;  // both F in one manifold
  EXPECT_LT(worst_difference(carried(f, 1), expected), 1e-6);
}

/// The field along z passes by zero twice in each period, 20 nT or 10 fT away from it.
TEST(LevelWay, IsDrivenByAFieldThatPassesJustByZero) {
  for (const double across : {20e-9, 1e-14}) {
    Flight f = flight(structure(3, 1, 50e6, 0, 2, -1e-3), 5000, 0.02, linear(0, 0, 0.5e-6, 0, 0, 0), 0);
    swing(f, ShapedTerm(linear(across, 0, 0, 0, 0, 0)), 35e3);
    swing(f, ShapedTerm(linear(0, 0, 10e-6, 0, 0, 0)), 100e6);
    f.fields.sections[0].shaped_end = 3;
    f.apart = 1e9;
    const std::vector<double> p = carried(f, 2);
    EXPECT_LT(worst_difference(p, Laboratory(f).carried(2)), 2e-6) << across;
    EXPECT_LT(p[2], 0.5);
  }
}

/// Landau-Zener: what leaves its level is exp(-pi gamma B_t^2/(2 |dB_l/dt|)), here with gamma B_t = 1 and
/// gamma dB_l/dt = 1; then Majorana for more levels.
TEST(LevelWay, FlipsASpinAsLandauZenerAndMajoranaSay) {
  for (const int twice_j : {1, 2, 3}) {
    const CoupledSpins spin = structure(0, twice_j, 0, 0, 2, 0);
    const double gamma = two_pi * spin.zeeman_j, across = 1e-6,
                 time = 1 / (gamma * across);  // [s] 1/(gamma B_t)
    const double speed = 1000, length = 400 * speed * time, slope = across / (speed * time);
    const Flight f = flight(spin, speed, length, linear(across, 0, 0, 0, 0, slope), length / 2);
    const double leaves = std::exp(-std::numbers::pi / 2);
    EXPECT_NEAR(leaves, 0.20788, 1e-5);
    const MajoranaTable table = majorana_table(twice_j);
    const std::vector<double> p = carried(f, 0);
    for (int to = 0; to <= twice_j; ++to) {
      double expected = 0;
      for (int power = twice_j; power >= 0; --power)
        expected =
            expected * leaves + table.coefficients[static_cast<std::size_t>(to * (twice_j + 1) + power)];
      EXPECT_NEAR(p[static_cast<std::size_t>(to)], expected, 2e-6) << twice_j << to;
    }
  }
}

TEST(LevelWay, LeavesLevelsWhereTheyAreInAFieldThatKeepsItsDirectionThroughZero) {
  const Flight f = flight(of("H atom"), 1000, 0.02, linear(0, 0, 0, 0, 0, 0.5), 0.01);
  const std::vector<double> p = carried(f, 0);  // F=1 m=1 is m=-1 of the opposite field
  EXPECT_NEAR(p[2], 1, 1e-9);
}

TEST(LevelWay, TurnsAtOnceWhereOneFieldEndsAndAnotherBegins) {
  // From no field, along +z, into one along x and out again: by a quarter turn twice, with Larmor phases
  // between.
  Flight f = flight(structure(0, 1, 0, 0, 2, 0), 1000, 0.01, linear(1e-6, 0, 0, 0, 0, 0), 0);
  f.fields.begins_in_field = f.fields.ends_in_field = false;
  const double angle = two_pi * f.spins.zeeman_j * 1e-6 * f.length / f.speed;
  EXPECT_NEAR(carried(f, 0)[0], std::pow(std::cos(angle / 2), 2), 1e-8);
  f.fields.begins_in_field = true;  // it starts in a level along x
  EXPECT_NEAR(carried(f, 0)[0], 0.5, 1e-8);
}

TEST(LevelWay, GivesTheSameBitsOnEachInstructionSet) {
  std::vector<Flight> flights{past_zero(of("K-39 atom")), past_zero(of("ortho-H2")), in_pulses(),
                              past_a_ring(20e-6)};
  flights[1].apart = 1e8;
  for (const Flight& f : flights) {
    const std::vector<double> p = all_carried(f, 1, Isa::baseline);
    for (const Isa isa : {Isa::avx2, Isa::avx512}) {
      if (supported(isa)) {
        EXPECT_EQ(all_carried(f, 1, isa), p) << f.spins.levels();
      }
    }
  }
}

/// One per cent of the field across is seen.
TEST(LevelWay, FeelsTheFieldAcross) {
  const Flight f = past_zero(of("K-39 atom"));
  Flight other = f;
  other.fields.shaped[0].linear.field[0] *= 1.01;
  EXPECT_GT(worst_difference(carried(f, 1), carried(other, 1)), 1e-3);
}

}  // namespace
}  // namespace rabiline::level_way_test
