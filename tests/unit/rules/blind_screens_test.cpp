#include "rules/blind_screens.hpp"

#include <gtest/gtest.h>

#include "physics/suggested.hpp"

namespace rabiline::blind_screens_test {
namespace {

using test::place;

/// Two points of a beam, with what a test does to it.
template <class Change>
std::string note(Change change, double second = 295e3, Law law = QuantumLaw{}) {
  Experiment e;
  for (const double frequency : {291.6e3, second}) {
    Beamline b = test::suggested(frequency);
    b.law = law;
    change(b);
    e.points.push_back(std::move(b));
  }
  return note_on_blind_screens(e);
}
void as_it_is(Beamline&) {}

TEST(BlindScreens, AreToldWhereTheScanTurnsSpinsAlone) {
  EXPECT_NE(note(as_it_is).find("in front of `screen` sorts spins"), std::string::npos);
  EXPECT_NE(note(as_it_is, 295e3, ClassicalLaw{}), "");
}

TEST(BlindScreens, AreNotToldWhereSpinsTurnPathsOrTheScanChangesNothing) {
  EXPECT_EQ(note(as_it_is, 295e3, DoradoLaw{}), "");
  EXPECT_EQ(note(as_it_is, 291.6e3), "");
}

TEST(BlindScreens, AreNotToldWhereTheScanChangesMoreThanSpins) {
  double width = 1e-3;
  EXPECT_EQ(note([&](Beamline& b) {
              b.parts.push_back(place("S", 0.7, Slit{Rectangle{width *= 2, 1e-3}, {}}));
            }),
            "");
}

TEST(BlindScreens, AreNotToldBehindWhatSortsSpins) {
  EXPECT_EQ(note([](Beamline& b) {
              b.parts.insert(b.parts.begin() + 3, place("F", 0.8, SpinFilter{UnitVector{0, 0, 1}, 1, 0}));
            }),
            "");
  EXPECT_EQ(
      note([](Beamline& b) { b.parts.insert(b.parts.begin() + 3, place("M", 0.8, test::magnet(0.1, 10))); }),
      "");
  EXPECT_NE(note([](Beamline& b) { b.parts.push_back(place("M", 1.5, test::magnet(0.1, 10))); }), "");
}

TEST(BlindScreens, AreToldBehindWhatSortsSpinsInFrontOfTheDriveAlone) {
  const std::string told = note([](Beamline& b) {
    b.parts.insert(b.parts.begin(), place("F", 0.05, SpinFilter{UnitVector{0, 0, 1}, 1, 0}));
  });
  EXPECT_NE(told.find("no part behind `H0` and in front of `screen` sorts spins"), std::string::npos) << told;
}

}  // namespace
}  // namespace rabiline::blind_screens_test
