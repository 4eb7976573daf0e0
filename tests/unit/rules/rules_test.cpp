// A beamline that a program builds has the same faults as one that a file states.
#include "rules/rules.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "core/constants.hpp"
#include "physics/suggested.hpp"

namespace rabiline::rules_test {
namespace {

using test::place;
using test::suggested;

template <class P>
P& part_in(Beamline& b, std::string_view name) {
  for (PlacedPart& part : b.parts)
    if (part.placement.name == name) return std::get<P>(part.part);
  throw std::out_of_range("no such part");
}

struct Broken {
  const char* what;
  std::string subject, key, message;
  std::function<void(Beamline&)> spoil;
};
std::ostream& operator<<(std::ostream& out, const Broken& broken) { return out << broken.what; }

const std::vector<Broken> broken_experiments{
    {"AFieldOfNoLength", "B", "length", "`length` must be greater than zero, but is 0",
     [](Beamline& b) { part_in<UniformField>(b, "B").length = 0; }},
    {"ANumberThatIsNone", "source", "speed.mean", "`speed.mean` must be greater than zero, but is nan",
     [](Beamline& b) {
       b.source.speed = GaussianSpeed{std::nan(""), 10};
     }},
    {"ANameThatIsReserved", "source", "name",
     "a part cannot be called `source`: the word means something else in files and results",
     [](Beamline& b) { b.parts[1].placement.name = "source"; }},
    {"ANameTwice", "parts[2]", "name", "the name `B` is taken by the uniform_field at 300 mm",
     [](Beamline& b) { b.parts[2].placement.name = "B"; }},
    {"NoDetector", "", "parts",
     "there is no detector among the parts, so the experiment would measure nothing",
     [](Beamline& b) { b.parts.pop_back(); }},
    {"ADetectorOfNoWidth", "screen", "width", "the `width` of `screen` must be greater than zero",
     [](Beamline& b) {
       part_in<Detector>(b, "screen").face = Rectangle{0, 1e-3};
     }},
    {"AClockWithoutFrequency", "H0", "kind", "the rotating_field `H0` needs `frequency`",
     [](Beamline& b) { part_in<RotatingField>(b, "H0").frequency.reset(); }},
    {"AClockThatIsNotThere", "H0", "oscillator",
     "there is no rotating_field `G` whose clock `H0` could follow",
     [](Beamline& b) {
       auto& field = part_in<RotatingField>(b, "H0");
       field.oscillator = "G", field.frequency.reset(), field.sense.reset();
       field.phase = {Phase::Kind::locked, 0};
     }},
    {"AnAimAtNothing", "source", "direction.target", "there is no slit or detector `S` to aim the source at",
     [](Beamline& b) { b.source.direction = AimedDirection{"S"}; }},
    {"AnAtomUnderTheHypothesis", "law", "name",
     "the law dorado turns the velocity with one spin and its gamma, but `Cs-133 atom` has 16 levels and no "
     "single gamma",
     [](Beamline& b) {
       b.species = {{*find_species("Cs-133 atom"), 1}};
     }},
    {"SharesThatDoNotAddUp", "species", "", "the fractions of the species add up to 0.9, not to 1",
     [](Beamline& b) {
       Species other = test::neutron();
       other.name = "other";
       b.species = {{test::neutron(), 0.5}, {other, 0.4}};
     }},
    {"AScreenOutsideTheChamber", "screen", "offset",
     "`screen` lies outside the chamber: it begins 68 mm from the axis, and the wall is at 50 mm",
     [](Beamline& b) {
       part_in<Detector>(b, "screen").offset = {0.07, 0};
     }},
    {"ATallyWithoutEnds", "screen", "tallies[0].axes[0].quantity",
     "the axis `x` needs `from`, `to` and `bins`",
     [](Beamline& b) {
       part_in<Detector>(b, "screen").tallies = {{"t", {TallyAxis{}}}};
     }},
    {"MoreFieldsThanKernelsHold", "again7", "at",
     "9 alternating or turning fields overlap from 350 mm to 550 mm, and 8 are the most",
     [](Beamline& b) {
       for (int i = 0; i < 8; ++i)
         b.parts.push_back(place("again" + std::to_string(i), 0.35, b.parts[2].part));
     }},
    {"APhaseBeyondWhatIsKnown", "H0", "frequency",
     "neutron would turn by 3.5e+09 radians before a particle leaves the field at 550 mm: more than 1e+08, "
     "beyond which its phase is no longer known",
     [](Beamline& b) { part_in<RotatingField>(b, "H0").frequency = 1e12; }},
};

class BrokenExperiment : public testing::TestWithParam<Broken> {};

TEST_P(BrokenExperiment, HasOneFaultWithASubjectAndAKey) {
  Beamline beamline = suggested(291.6e3);
  ASSERT_TRUE(faults_of(beamline).empty());
  GetParam().spoil(beamline);
  const std::vector<Fault> faults = faults_of(beamline);
  ASSERT_EQ(faults.size(), 1U) << faults.back().message;
  EXPECT_EQ(faults[0].subject, GetParam().subject);
  EXPECT_EQ(faults[0].key, GetParam().key);
  EXPECT_EQ(faults[0].message, GetParam().message);
  EXPECT_EQ(faults[0].severity, Severity::error);
}
INSTANTIATE_TEST_SUITE_P(Rules, BrokenExperiment, testing::ValuesIn(broken_experiments),
                         [](const auto& test) { return test.param.what; });

TEST(Rules, LetAStrongFieldPassWhereNobodyAsksForItsPhase) {
  Beamline b = suggested(291.6e3);
  b.law = QuantumLaw{};
  b.source.spin = PolarisedSpin{UnitVector{}, 1};
  b.parts = {place("B", 0.3, UniformField{0.25, 1e4, {}}), b.parts.back()};
  EXPECT_TRUE(faults_of(b).empty());
  part_in<UniformField>(b, "B").direction = {1, 0, 0};
  ASSERT_EQ(faults_of(b).size(), 1U);
  EXPECT_EQ(faults_of(b)[0].subject, "B");
  EXPECT_EQ(faults_of(b)[0].key, "field");
}

TEST(Rules, ForbidAScanThatChangesWhatAllPointsShare) {
  Beamline other = suggested(291.6e3);
  part_in<Detector>(other, "screen").bins = {2, 2};
  const auto fault = fault_of_axis("screen.bins", {suggested(291.6e3), other});
  ASSERT_TRUE(fault.has_value());
  EXPECT_EQ(fault->message,
            "`screen.bins` cannot be scanned: all points fill the same histogram of `screen`");
  EXPECT_FALSE(fault_of_axis("H0.frequency", {suggested(291e3), suggested(292e3)}).has_value());
}

}  // namespace
}  // namespace rabiline::rules_test
