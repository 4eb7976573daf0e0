// What `check` says of atoms: of files as people write them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "plan/explain.hpp"
#include "plan/explain_atoms.hpp"
#include "plan/plan.hpp"
#include "rules/warnings.hpp"
#include "scan/experiment.hpp"

namespace rabiline::explain_atoms_test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A beam of caesium through a magnet A, a field C with an RF zone R, and a detector D.
constexpr const char* clock_file = R"(rabiline: 1
species: Cs-133 atom
law: quantum
source:
  speed: {kind: single, value: 250 m/s}
  opening: {radius: 0.1 mm}
  direction: parallel
parts:
  - {name: A, kind: iron_magnet, at: 0.1 m, length: 0.1 m, field: 0.1 T, half_distance: 1 mm, convex: 0.8 mm, concave: 1.8 mm, width: 2 mm, beam_height: 1.3 mm}
  - {name: C, kind: uniform_field, at: 0.3 m, length: 0.6 m, field: 10 uT}
  - {name: R, kind: oscillating_field, at: 0.5 m, length: 25 mm, amplitude: 1 uT, direction: z, frequency: 9192.632 MHz, approximation: rotating_wave, phase: random}
  - {name: D, kind: detector, at: 1.2 m, width: 40 mm, height: 40 mm, bins: [8, 8]}
particles: 100
seed: 1
)";

class ExplainAtoms : public testing::Test {
 protected:
  ExplainAtoms() { std::ofstream(path_) << clock_file; }
  ~ExplainAtoms() override { std::filesystem::remove(path_); }
  std::string check(std::vector<std::string> set = {}, std::vector<std::string> scan = {}) const {
    Changes line;
    line.set = std::move(set);
    line.scan = std::move(scan);
    const Experiment experiment = load_experiment(load_file(path_), line).experiment;
    const Plan plan = make_plan(experiment);
    std::string text = explain(experiment, plan);
    for (const Fault& fault : warnings_of(experiment, plan)) text += "warning: " + fault.message + "\n";
    return text;
  }
  /// Tests run side by side.
  const std::filesystem::path path_ =
      std::filesystem::temp_directory_path() /
      (std::string("rabiline_explain_atoms_") +
       testing::UnitTest::GetInstance()->current_test_info()->name() + ".yaml");
};

TEST_F(ExplainAtoms, BeginsWithLevelsInsteadOfOneMoment) {
  EXPECT_THAT(check(),
              HasSubstr("Cs-133 atom: I = 7/2, J = 1/2, 16 levels, F=4 above F=3 by 9192.63177 MHz"));
  EXPECT_THAT(check({"law=classical", "R.frequency=1 kHz"}),
              HasSubstr("Cs-133 atom: spin 1/2, gamma/2pi -28028 MHz/T"));
}

TEST_F(ExplainAtoms, NamesTheNearestTransitions) {
  const std::string text = check();
  EXPECT_THAT(text, HasSubstr("spins at D: 16 levels, coherent through the fields below"));
  EXPECT_THAT(text, HasSubstr("R drives from 0.5000 to 0.5250 m\n"));
  EXPECT_THAT(text, HasSubstr("at B = 10 uT: 9192.632 MHz, width v/L 10 kHz"));
  // 9192.63177 MHz + 427.45 Hz/G^2 (0.1 G)^2; (g_J - g_I') mu_B B/2h = 14.02 kHz each way for 1 uT.
  EXPECT_THAT(
      text, HasSubstr("F=4 m=0 - F=3 m=0 at 9192.631774 MHz, detuned by 225.7 Hz, Rabi frequency 14.02 kHz"));
  EXPECT_THAT(text, HasSubstr("probabilities worked out for each particle, exact at every speed"));
  EXPECT_THAT(text, HasSubstr("no field from 0.2 to 0.3 m: levels keep their names"));
  EXPECT_THAT(text, Not(HasSubstr("warning")));
}

TEST_F(ExplainAtoms, TellsTwoFieldsAtOnePlaceApart) {
  std::ofstream(path_) << std::string(clock_file)
                              .insert(std::string(clock_file).find("  - {name: D"),
                                      "  - {name: S, kind: oscillating_field, at: 0.51 m, length: 5 mm, "
                                      "amplitude: 1 uT, direction: z, frequency: "
                                      "20 MHz, approximation: none, phase: random}\n");
  const std::string text = check();
  EXPECT_THAT(text, HasSubstr("R drives from 0.5000 to 0.5100 m"));
  EXPECT_THAT(text, HasSubstr("9192.632 MHz, width v/L 10 kHz"));  // of 25 mm, not of a piece
  EXPECT_THAT(text, HasSubstr("pi 1 uT, sigma+ 0 T, sigma- 0 T"));
  EXPECT_THAT(text, HasSubstr("S drives from 0.5100 to 0.5150 m"));
  EXPECT_THAT(text, HasSubstr("R drives from 0.5150 to 0.5250 m, as R does"));
  EXPECT_THAT(text, HasSubstr("warning: `S` drives no transition"));
  EXPECT_THAT(text, Not(HasSubstr("`R` drives no transition")));
}

TEST_F(ExplainAtoms, WarnsWhereAFieldDrivesNothing) {
  const char* message =
      "`R` drives no transition: at B = 10 uT and 9000 MHz, nearest are F=4 m=-3 - F=3 m=-3 at";
  EXPECT_THAT(check({"R.frequency=9 GHz"}), HasSubstr(message));
  EXPECT_THAT(check({"R.frequency=9 GHz", "R.amplitude=300 uT"}), Not(HasSubstr("drives no transition")));
}

TEST_F(ExplainAtoms, WarnsWhereWhatTheRotatingWaveApproximationLeavesOutShiftsTheLineByAShareOfItsWidth) {
  EXPECT_THAT(
      check({"R.amplitude=50 mT"}),
      HasSubstr("what the rotating-wave approximation of `R` leaves out may shift F=4 m=0 - F=3 m=0 by "
                "up to 174.6 kHz, and the line's width is 10 kHz"));
  EXPECT_THAT(check({"R.amplitude=10 mT"}), Not(HasSubstr("leaves out")));
}

TEST_F(ExplainAtoms, WarnsOfThePoorRotatingWaveApproximationOfADrive) {
  const auto driven = [&](const char* amplitude) {
    return check({"R.direction=[1, 0, 0]", "R.frequency=35 kHz", std::string("R.amplitude=") + amplitude});
  };
  const char* poor = "the rotating-wave approximation of `R` is poor: ";
  EXPECT_THAT(driven("1 uT"), Not(HasSubstr(poor)));
  EXPECT_THAT(driven("10 uT"), HasSubstr(std::string(poor) + "amplitudes up to 0."));
  EXPECT_THAT(driven("1 mT"), HasSubstr(std::string(poor) + "what it leaves out is too strong for that"));
}

TEST_F(ExplainAtoms, WarnsOfAScanOnlyWhereNoPointDrivesAnything) {
  EXPECT_THAT(check({}, {"R.frequency=9 GHz:9.1 GHz:5"}),
              HasSubstr("`R` drives no transition at any scan point"));
  EXPECT_THAT(check({}, {"R.frequency=9 GHz:9192.632 MHz:5"}), Not(HasSubstr("drives no transition")));
}

TEST_F(ExplainAtoms, WarnsOfAScanThatStopsShortOfEveryLine) {
  const auto scan = [&](const char* to) {
    return check({}, {std::string("R.frequency=9192.4 MHz:") + to + ":5"});
  };
  // The line is 10 kHz wide, and its neighbours are 70 kHz away on either side: m = -1 below, m = +1 above.
  EXPECT_THAT(
      check({"R.amplitude=10 nT"}, {"R.frequency=9192.655 MHz:9192.66 MHz:2"}),
      HasSubstr("no scan point is near a line that `R` drives: the nearest is 23.23 kHz away from F=4 "
                "m=0 - F=3 m=0 at 9192.631774 MHz, and the line's width is 10 kHz"));
  EXPECT_THAT(check({"R.amplitude=10 nT"}, {"R.frequency=9192.60 MHz:9192.655 MHz:2"}),
              Not(HasSubstr("no scan point")));  // a line is crossed between them
  EXPECT_THAT(scan("9192.632 MHz"), Not(HasSubstr("no scan point")));
  EXPECT_THAT(check({"R.amplitude=10 nT", "R.frequency=9192.66 MHz"}, {"R.phase=0 deg:90 deg:2"}),
              Not(HasSubstr("no scan point")));  // nothing of it is scanned
}

TEST_F(ExplainAtoms, KnowsWhichLinesADriveSweepsThrough) {
  const auto swept = [&](const char* to) {
    return check({"R.frequency=9190 MHz", std::string("R.sweep={begin: 2 ms, end: 2.1 ms, to: ") + to + "}"});
  };
  EXPECT_THAT(swept("9190.2 MHz"), HasSubstr("`R` drives no transition: at B = 10 uT and 9190.2 MHz"));
  const std::string through = swept("9192.72 MHz");
  EXPECT_THAT(through, Not(HasSubstr("drives no transition")));
  EXPECT_THAT(through, HasSubstr("detuned by 0 Hz"));
  EXPECT_THAT(check({"R.frequency=9195 MHz", "R.sweep={begin: 2 ms, end: 2.1 ms, to: 9192.5 MHz}"}),
              Not(HasSubstr("drives no transition")));
}

TEST_F(ExplainAtoms, WarnsOfADriveThatTurnsLevelsRoundAndRound) {
  // 14.02 kHz for 1 uT, over 1/(10 kHz).
  EXPECT_THAT(check({"R.amplitude=75 uT"}),
              HasSubstr("`R` drives 105 Rabi cycles of F=4 m=0 - F=3 m=0, and half a cycle is a whole flip"));
  EXPECT_THAT(check({"R.amplitude=70 uT"}), Not(HasSubstr("Rabi cycles")));
}

TEST_F(ExplainAtoms, FollowsLevelsInAFieldAgainstTheAxisInClosedForm) {
  const std::string text = check({"C.field=-10 uT"});
  EXPECT_THAT(text, HasSubstr("at B = -10 uT: 9192.632 MHz"));
  EXPECT_THAT(text, HasSubstr("its parts about +z, against B: pi 1 uT, sigma+ 0 T, sigma- 0 T"));
  EXPECT_THAT(text, HasSubstr("probabilities worked out for each particle, exact at every speed"));
}

TEST_F(ExplainAtoms, TellsHowFarDownStepsThroughAProfileAreRight) {
  EXPECT_THAT(check({"source.speed={kind: effusive, temperature: 370 K}", "R.profile=half_sine"}),
              HasSubstr("profiles in steps, to 1e-8 down to 143 m/s; all else exact"));
}

TEST_F(ExplainAtoms, TellsTheShiftByWhatDoesNotTurnWithATransition) {
  // Pairs of levels are pushed apart by (C/2)^2/(E + f): 2 (7.008 kHz)^2/18.385 GHz for 1 uT.
  EXPECT_THAT(check(), HasSubstr("; what turns otherwise shifts it by 5.343 mHz"));
}

TEST_F(ExplainAtoms, WarnsWhereEveryLevelMeetsTheWalls) {
  const std::string text = check({"A.field=3 T"});
  EXPECT_THAT(text, HasSubstr("16 of 16 levels meet its walls"));
  EXPECT_THAT(text, HasSubstr("warning: `A` pushes every level into its walls: at 250 m/s"));
  EXPECT_THAT(text, HasSubstr("nothing that flies along the axis can arrive"));
  EXPECT_THAT(check(), Not(HasSubstr("meet its walls")));
}

TEST_F(ExplainAtoms, TellsHowManyWaysShareThePaths) {
  std::string text = clock_file;
  const std::size_t screen = text.find("  - {name: D");
  text.insert(
      screen,
      "  - {name: B, kind: gradient_magnet, at: 1 m, length: 0.1 m, field: 1 T, gradient: 100 T/m}\n");
  std::ofstream(path_) << text;
  const std::string told = check({}, {"R.frequency=9192.6 MHz:9192.66 MHz:5"});
  EXPECT_THAT(told, HasSubstr("B: each particle is in one level from here on, all are followed"));
  EXPECT_THAT(told,
              HasSubstr("its paths in 16 levels are flown once and reweighted for 5 settings one by one"));
  EXPECT_THAT(told, HasSubstr("scan point 3: 9192.63 MHz"));
}

TEST_F(ExplainAtoms, TellsOnceWhatDrivesLevelsInFrontOfSeveralParts) {
  std::string text = clock_file;
  text.insert(text.find("  - {name: D"),
              "  - {name: M, kind: monitor, at: 1 m, width: 1 cm, height: 1 cm, tallies: [{name: l, axes: "
              "[level]}]}\n");
  std::ofstream(path_) << text;
  const std::string told = check();
  const std::size_t first = told.find("R drives from");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(told.find("R drives from", first + 1), std::string::npos) << told;
  EXPECT_THAT(told, HasSubstr("what drives levels is as told of M\n"));
}

TEST_F(ExplainAtoms, TellsWhyScanPointsAreReadOneByOne) {
  EXPECT_THAT(check({}, {"R.frequency=9192.6 MHz:9192.66 MHz:5"}),
              HasSubstr("scan points are read one by one: levels of atoms are mixed for each particle"));
  EXPECT_THAT(check(), Not(HasSubstr("one by one")));
}

}  // namespace
}  // namespace rabiline::explain_atoms_test
