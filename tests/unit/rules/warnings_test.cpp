// Experiments that run and cannot find what they look for.
#include "rules/warnings.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "physics/atoms.hpp"
#include "physics/suggested.hpp"
#include "warned.hpp"

namespace rabiline::warnings_test {
namespace {

using test::place;
using test::standard;
using test::warned;

struct Blunder {
  const char* what;
  std::string subject, key;
  std::function<void(Beamline&)> make;
};
std::ostream& operator<<(std::ostream& out, const Blunder& blunder) { return out << blunder.what; }

const std::vector<Blunder> blunders{
    {"ADetectorInFrontOfEverything", "screen", "at", [](Beamline& b) { b.parts[3].placement.at = 0.05; }},
    {"AClosedSlit", "S", "width",
     [](Beamline& b) {
       b.parts.push_back(place("S", 0.7, Slit{Rectangle{0, 1e-3}, {}}));
     }},
    {"ASlitOutOfReach", "S", "offset",
     [](Beamline& b) {
       b.parts.push_back(place("S", 0.7, Slit{Rectangle{1e-3, 1e-3}, {5e-3, 0}}));
     }},
    {"ASourceBesideTheAxis", "source", "offset",
     [](Beamline& b) {
       b.source.offset = {5e-3, 0};
     }},
    {"ADetectorInsideAField", "screen", "at", [](Beamline& b) { b.parts[3].placement.at = 0.4; }},
    {"OverlappingZonesOfOneClock", "H1", "at",
     [](Beamline& b) {
       RotatingField second = std::get<RotatingField>(b.parts[2].part);
       second.oscillator = "H0", second.frequency.reset(), second.sense.reset();
       second.phase = {Phase::Kind::locked, 0};
       second.length = 0.1;
       b.parts.push_back(place("H1", 0.45, second));
     }},
    {"HertzForKilohertz", "H0", "frequency",
     [](Beamline& b) { std::get<RotatingField>(b.parts[2].part).frequency = 291.6; }},
    {"HertzForKilohertzOfAStrongField", "H0", "frequency",
     [](Beamline& b) {
       std::get<RotatingField>(b.parts[2].part).frequency = 291.6;
       std::get<RotatingField>(b.parts[2].part).amplitude = 0.8e-3;  // 23 kHz: 0.6 % flip at most
     }},
    {"ADriveOfUnpolarisedSpins", "H0", "at", [](Beamline& b) { b.parts.erase(b.parts.begin()); }},
    {"APolarizerBehindTheCoil", "B_prime", "at", [](Beamline& b) { b.parts[0].placement.at = 0.7; }},
    {"ASlitBehindTheDetector", "S", "at",
     [](Beamline& b) {
       b.parts.push_back(place("S", 5, Slit{Rectangle{1e-3, 1e-3}, {}}));
     }},
    {"AFilterOfAllSpinsAlike", "F", "down",
     [](Beamline& b) {
       b.parts.push_back(place("F", 0.7, SpinFilter{UnitVector{1, 0, 0}, 0.5, 0.5, {}}));
     }},
    {"AFieldThatTurnsAgainstThePrecession", "H0", "sense",
     [](Beamline& b) { std::get<RotatingField>(b.parts[2].part).sense = Sense::counter; }},
};

class WarnsOf : public testing::TestWithParam<Blunder> {};

TEST_P(WarnsOf, ABlunderOnceAndOnlyWhereEveryPointMakesIt) {
  ASSERT_TRUE(warned({standard()}).empty());
  Beamline spoiled = standard();
  GetParam().make(spoiled);
  const std::vector<Fault> faults = warned({spoiled});
  ASSERT_EQ(faults.size(), 1U) << (faults.empty() ? "" : faults.back().message);
  EXPECT_EQ(faults[0].subject, GetParam().subject);
  EXPECT_EQ(faults[0].key, GetParam().key);
  EXPECT_EQ(faults[0].severity, Severity::warning);
  EXPECT_TRUE(warned({spoiled, standard()}).empty());
}
INSTANTIATE_TEST_SUITE_P(Warnings, WarnsOf, testing::ValuesIn(blunders),
                         [](const auto& test) { return test.param.what; });

TEST(Warnings, SayThatNothingFallsWhereAFallWouldMatter) {
  Beamline b = standard();
  const auto with_slit = [&](double height) {
    Beamline slit = b;
    slit.parts.insert(slit.parts.end() - 1, place("S", 1.1, Slit{Rectangle{1e-3, height}, {}}));
    return warned({slit});
  };
  // 9.8 m/s^2/2 (1.2 ms)^2 = 7.1 um
  EXPECT_TRUE(with_slit(70.9e-6).empty());
  const std::vector<Fault> faults = with_slit(70.3e-6);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].subject, "gravity");
  EXPECT_NE(faults[0].message.find("the opening of `S` is 70.3 um high"), std::string::npos)
      << faults[0].message;
  b.gravity = Gravity{};
  EXPECT_TRUE(with_slit(70.3e-6).empty());
}
TEST(Warnings, TakeNoOpeningForOutOfReachThatParticlesFallTo) {
  Beamline b = standard();
  b.parts.push_back(place("S", 0.7, Slit{Rectangle{1e-3, 1e-3}, {0, -5e-3}}));
  EXPECT_EQ(warned({b}).size(), 1U);
  b.gravity = Gravity{2e4, {0, 0, -1}};
  for (const Fault& fault : warned({b})) EXPECT_NE(fault.subject, "S") << fault.message;
}

TEST(Warnings, LeaveOutPointsAtWhichADriveHasNoSize) {
  const auto at = [](double frequency, double amplitude) {
    Beamline b = standard();
    std::get<RotatingField>(b.parts[2].part).frequency = frequency;
    std::get<RotatingField>(b.parts[2].part).amplitude = amplitude;
    return b;
  };
  for (const auto& [first, last] : {std::pair{0.0, 0.3e-6}, {0.3e-6, 0.0}}) {
    const std::vector<Fault> faults = warned({at(291.6, first), at(291.6, last)});
    ASSERT_EQ(faults.size(), 1U);
    EXPECT_EQ(faults[0].key, "frequency");
  }
  EXPECT_TRUE(warned({at(291.6, 0), at(291.6, 0)}).empty());
  EXPECT_TRUE(warned({at(291.6, 0), at(291.6e3, 0.3e-6)}).empty());
}

/// Two zones of one clock in fields of a size and its sign.
Beamline two_zones(double field, Sense sense, double second_field) {
  Beamline b = standard();
  std::get<Polarizer>(b.parts[0].part).field = field;
  std::get<UniformField>(b.parts[1].part).field = field;
  std::get<RotatingField>(b.parts[2].part).sense = sense;
  RotatingField second = std::get<RotatingField>(b.parts[2].part);
  second.oscillator = "H0", second.frequency.reset(), second.sense.reset();
  second.phase = {Phase::Kind::locked, 0};
  b.parts.insert(b.parts.begin() + 3, place("C", 0.6, UniformField{0.25, second_field, {}}));
  b.parts.insert(b.parts.begin() + 4, place("H1", 0.62, second));
  return b;
}
TEST(Warnings, SayHowAFieldThatTurnsAgainstThePrecessionIsTurnedRound) {
  const std::pair<double, Sense> wrong[] = {
      {-10e-3, Sense::co}, {10e-3, Sense::counter}, {10e-3, Sense::negative}, {-10e-3, Sense::positive}};
  const char* help[] = {"`sense: counter`", "`sense: co`", "`sense: positive`", "`sense: negative`"};
  const Sense right[] = {Sense::counter, Sense::co, Sense::positive, Sense::negative};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& [field, sense] = wrong[i];
    const std::vector<Fault> faults = warned({two_zones(field, sense, field)});
    ASSERT_EQ(faults.size(), 1U);  // of both, where the sense stands
    EXPECT_EQ(faults[0].subject, "H0");
    EXPECT_EQ(faults[0].key, "sense");
    EXPECT_NE(faults[0].help.find(help[i]), std::string::npos) << faults[0].help;
    EXPECT_TRUE(warned({two_zones(field, right[i], field)}).empty());
  }
  const std::vector<Fault> faults = warned({two_zones(10e-3, Sense::co, -10e-3)});
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].subject, "H1");
  EXPECT_EQ(faults[0].key, "oscillator");
}

TEST(Warnings, TellThatADriveStandsInNoStaticField) {
  Beamline b = standard();
  b.parts.erase(b.parts.begin() + 1);
  const std::vector<Fault> faults = warned({b});
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].subject, "H0");
  EXPECT_NE(faults[0].message.find("no static field"), std::string::npos);
}

TEST(Warnings, TakeAFieldWithAFringeForAStaticField) {
  Beamline b = standard();
  std::get<UniformField>(b.parts[1].part).fringe = TanhFringe{1e-3};
  for (const Fault& fault : warned({b}))
    EXPECT_EQ(fault.message.find("no static field"), std::string::npos) << fault.message;
}

TEST(Warnings, TellThatAtomsAreDrivenInNoStaticField) {
  Beamline b = test::atoms("K-39 atom", 600, test::in_level(2, 2));
  b.parts = {place("C", 0.2, UniformField{0.4, 1e-4, {}}),
             place("rf", 0.3, test::swinging(0.1, 1e-6, 461.7e6)), test::wide_screen(1)};
  const auto is_told = [&] {
    return std::ranges::any_of(warned({b}), [](const Fault& f) {
      return f.subject == "rf" &&
             f.message.find("drives atoms where there is no static field") != f.message.npos;
    });
  };
  EXPECT_FALSE(is_told());
  b.parts[0].placement.at = 0.5;
  EXPECT_TRUE(is_told());
}

/// Silver through a magnet of so many T/m onto bins of 20 um.
Beamline silver(const std::string& species, double gradient) {
  Beamline b = test::atoms(species, 600, UnpolarisedSpin{});
  b.source.opening = Rectangle{0.8e-3, 0.03e-3};
  b.parts = {place("magnet", 0.05, test::magnet(0.035, gradient)),
             place("plate", 0.09, Detector{Rectangle{2e-3, 2e-3}, {40, 100}, {}})};
  return b;
}
TEST(Warnings, TellThatANucleusIsTooWeakForTheMagnetsOfItsAtom) {
  const std::vector<Fault> faults = warned({silver("Ag-107", 0), silver("Ag-107", 1000)});
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].subject, "species");
  EXPECT_EQ(faults[0].help, "did you mean `Ag-107 atom`?");
  EXPECT_EQ(
      std::ranges::count(warned({silver("Ag-107", 1000), silver("Ag-107", 1e7)}), "species", &Fault::subject),
      0);
  EXPECT_TRUE(warned({silver("Ag-107 atom", 1000)}).empty());
  EXPECT_TRUE(warned({silver("Xe-129", 1000)}).empty());  // which has no such atom here
}

/// Neutrons from a slit of some height through a field along z with a fringe of 1 cm.
std::vector<Fault> warned_of_fringe(const Fringe& fringe, double height) {
  Beamline b = test::suggested(0);
  b.law = QuantumLaw{};
  b.chamber.reset();
  b.source.opening = Rectangle{1e-3, height};
  UniformField field{0.2, 10e-6, {}};
  field.fringe = fringe;
  b.parts = {place("B", 0.3, field), place("screen", 1.2, Detector{Rectangle{0.1, 0.1}, {1, 1}, {}})};
  return warned({b});
}
TEST(Warnings, TellThatParticlesPassAFringeWhereItsCurveDoesNotTellTheField) {
  EXPECT_TRUE(warned_of_fringe(TanhFringe{10e-3}, 20e-3).empty());
  EXPECT_TRUE(warned_of_fringe(SineFringe{10e-3}, 1.4e-3).empty());
  for (const auto& [fringe, height] :
       {std::pair{Fringe{TanhFringe{10e-3}}, 30e-3}, {SineFringe{10e-3}, 2e-3}}) {
    const std::vector<Fault> faults = warned_of_fringe(fringe, height);
    ASSERT_EQ(faults.size(), 1U);
    EXPECT_EQ(faults[0].subject, "B");
    EXPECT_EQ(faults[0].key, "fringe");
  }
}

TEST(Warnings, TellThatAFringeGrowsOutwards) {
  EngeFringe fringe{.length = 10e-3};
  EXPECT_TRUE(warned_of_fringe(fringe, 1e-3).empty());
  fringe.a0 = 0.3, fringe.a1 = 2.1, fringe.a2 = -0.4, fringe.a3 = 0.2;  // the others are 0: it falls
  EXPECT_TRUE(warned_of_fringe(fringe, 1e-3).empty());
  fringe.a4 = -1.082657, fringe.a5 = 0.318111;
  const std::vector<Fault> faults = warned_of_fringe(fringe, 1e-3);
  ASSERT_FALSE(faults.empty());
  EXPECT_EQ(faults[0].subject, "B");
  EXPECT_EQ(faults[0].key, "fringe");
  EXPECT_NE(faults[0].message.find("does not fall all the way: outwards its field grows from"),
            std::string::npos);
}
TEST(Warnings, TellThatAFringeLeavesNothingWholeAndThatItReachesTheSource) {
  const auto tells = [](double length, const char* what) {
    return std::ranges::any_of(warned_of_fringe(TanhFringe{length}, 1e-3), [&](const Fault& fault) {
      return fault.message.find(what) != std::string::npos;
    });
  };
  for (const char* what : {"so long that its field comes to", "reaches the source, where its field is"}) {
    EXPECT_FALSE(tells(0.02, what));
    EXPECT_TRUE(tells(0.5, what));
  }
}
TEST(Warnings, TellThatParticlesRiseInsideOfAFieldToWhereItsFringeDoesNotTellIt) {
  for (const bool wide : {false, true}) {
    Beamline b = test::suggested(0);
    b.law = QuantumLaw{};
    b.chamber.reset();
    b.gravity = Gravity{9.81, {0, 0, -1}};
    // A throw that is on the axis at 0.3 m and 0.5 m, and 2 mm above it between.
    b.source.speed = SingleSpeed{5};
    b.source.opening = Rectangle{0, 0};
    b.source.direction = ParallelDirection{};
    b.source.tilt.x = std::atan(9.81 * 0.16 / 2 / 5);
    b.source.offset.z = -9.81 * 0.06 * 0.1 / 2;
    UniformField field{0.2, 10e-6, {}};
    field.fringe = wide ? Fringe{TanhFringe{10e-3}} : Fringe{SineFringe{10e-3}};
    b.parts = {place("B", 0.3, field), place("screen", 0.6, Detector{Rectangle{1, 1}, {1, 1}, {}})};
    const std::vector<Fault> faults = warned({b});
    EXPECT_EQ(std::ranges::count(faults, "fringe", &Fault::key), wide ? 0 : 1);
  }
}
TEST(Warnings, TellThatAMagnetHasMoreFieldThanThereIs) {
  for (const double gradient : {1e3, -1e9}) {
    Beamline b = standard();
    b.parts.push_back(
        place("M", 0.9, GradientMagnet{0.1, 0.5, gradient, {0, 0, 1}, Rectangle{5e-3, 5e-3}, {}}));
    const std::vector<Fault> faults = warned({b});
    EXPECT_EQ(std::ranges::any_of(faults,
                                  [](const Fault& f) {
                                    return f.subject == "M" && f.key == "gradient" &&
                                           f.message.find("no magnet has more") != std::string::npos;
                                  }),
              gradient < 0);
  }
}

TwoWireMagnet turned_wires(double turn) {
  TwoWireMagnet wires;
  wires.length = 0.3;
  wires.half_distance = 2e-3;
  wires.wire_radius = 1e-3;
  wires.strength = FieldAtBeam{0.3};
  wires.tilt.y = turn;
  return wires;
}
TEST(Warnings, TellThatLevelsOfAtomsAreTakenToFollowAMagnetThatIsTurned) {
  for (const double turn : {0.0, 5e-3, 0.5}) {
    Beamline b = test::atoms("K-39 atom", 200, test::in_level(2, 2));
    b.parts = {place("M", 0.1, turned_wires(turn)),
               place("screen", 1.3, Detector{Rectangle{0.1, 0.1}, {100, 100}, {}})};
    EXPECT_EQ(std::ranges::count(warned({b}), "tilt", &Fault::key), turn > 0.1 ? 1 : 0) << turn;
  }
}

TEST(Warnings, TellThatLevelsOfAtomsAreTakenToFollowAFieldThroughZero) {
  for (const double field : {1e-3, 0.1}) {
    Beamline b = test::atoms("K-39 atom", 200, test::in_level(2, 2));
    b.parts = {place("M", 0.1, GradientMagnet{0.1, field, 20, {0, 0, 1}, Rectangle{4e-3, 4e-3}, {}}),
               place("screen", 1.3, Detector{Rectangle{0.1, 0.1}, {100, 100}, {}})};
    EXPECT_EQ(std::ranges::any_of(warned({b}),
                                  [](const Fault& f) {
                                    return f.message.find("0 at 50 um from its middle") != f.message.npos;
                                  }),
              field < 0.1);
  }
}

TEST(Warnings, TellWhereTheFieldThatSortsLevelsJumps) {
  for (const double turn : {0.0, 0.5, 3.141592653589793}) {
    Beamline b = standard();
    b.law = QuantumLaw{};
    b.source.direction = ParallelDirection{};
    b.source.opening = Rectangle{1e-4, 1e-4};
    b.parts = {place("M", 0.5, turned_wires(0)), place("G", 0.75, UniformField{0.1, 1e-9, {}}),
               place("N", 0.8, turned_wires(turn)),
               place("screen", 1.3, Detector{Rectangle{0.1, 0.1}, {100, 100}, {}})};
    const std::vector<Fault> faults = warned({b});
    EXPECT_EQ(std::ranges::any_of(
                  faults, [](const Fault& f) { return f.message.find("jumps at") != std::string::npos; }),
              turn > 0)
        << turn;
  }
}

TEST(Warnings, TellThatLevelsOfAtomsAreTakenToFollowAFieldThatTurnsAtOnceWhereTheyAreSorted) {
  for (const bool turns : {false, true}) {
    Beamline b = test::atoms("Rb-85 atom", 500, test::in_level(3, 3));
    UniformField sorting{0.4, 20e-3, {}};
    sorting.direction = {1, 0, 0};
    sorting.gradient.quadrupole = 10;
    UniformField before{0.1, 20e-3, {}};
    if (!turns) before.direction = {1, 0, 0};
    b.parts = {place("U", 0.2, before), place("Q", 0.3, sorting),
               place("screen", 1.3, Detector{Rectangle{0.1, 0.1}, {100, 100}, {}})};
    EXPECT_EQ(
        std::ranges::any_of(
            warned({b}), [](const Fault& f) { return f.message.find("jumps at 300 mm") != f.message.npos; }),
        turns);
  }
}

/// Atoms through a gradient along x, whose bins are of a given size.
std::vector<Fault> warned_of_gradient(double bins, Outcomes outcomes) {
  Beamline b = test::atoms("Cs-133 atom", 200, test::in_level(4, 4));
  b.law = QuantumLaw{outcomes};
  b.source.opening = Rectangle{1e-4, 1e-4};
  UniformField field{0.2, 1e-4, {}};
  field.gradient.quadrupole = 1e-3;
  b.parts = {
      place("G", 0.1, field),
      place("screen", 1.3, Detector{Rectangle{0.01, 0.01}, {static_cast<int>(0.01 / bins + 0.5), 1}, {}})};
  return warned({b});
}
TEST(Warnings, TellThatAtomsInAGradientAreBetweenOnePathAndNoPhase) {
  const std::vector<Fault> faults = warned_of_gradient(1e-5, Outcomes::coherent);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].subject, "G");
  EXPECT_NE(faults[0].message.find(
                "too far apart for one path, too alike in phase for several; here levels stay coherent"),
            std::string::npos);
  EXPECT_TRUE(warned_of_gradient(1e-3, Outcomes::coherent).empty());
}

TEST(Warnings, TellNumbersThatNoApparatusHas) {
  const auto told = [](auto spoil) {
    Beamline b = standard();
    spoil(b);
    const std::vector<Fault> faults = warned({b});
    return faults.size() == 1 ? faults[0].subject + ": " + faults[0].message : std::to_string(faults.size());
  };
  EXPECT_EQ(told([](Beamline& b) { b.gravity = Gravity{1e30}; }),
            "gravity: `acceleration` of `gravity` is 1e+30 m/s^2: on the Sun it is 274 m/s^2");
  EXPECT_EQ(told([](Beamline& b) {
              b.source.opening = Rectangle{1e-30, 1e-3};
            }),
            "source: `opening.width` of `source` is 1e-30 m: an atom is larger than that");
  EXPECT_EQ(told([](Beamline& b) {
              std::get<Detector>(b.parts[3].part).face = Rectangle{4e-3, 1e30};
            }),
            "screen: `height` of `screen` is 1e+27 km: no beam is so long or so wide");
  EXPECT_EQ(told([](Beamline& b) { b.source.opening = Rectangle{0, 1e-3}; }), "0");
}

}  // namespace
}  // namespace rabiline::warnings_test
