// A shutter that opens periodically: which particles it lets pass follows from their time of flight.
#include <gtest/gtest.h>

#include <cmath>

#include "constants.hpp"
#include "physics/agreement.hpp"
#include "physics/suggested.hpp"

namespace rabiline::test::chopper_test {
namespace {

constexpr double at = 0.5, speed = 1000, frequency = 3e3;

/// Neutrons of one speed through a chopper to a wide detector.
Beamline through(const Chopper& part, double v = speed) {
  Beamline b = suggested(0);
  b.law = ClassicalLaw{};
  b.source.speed = SingleSpeed{v};
  b.chamber.reset();
  b.particles = 64;
  b.parts = {place("chopper", at, part), place("screen", 1.2, Detector{Rectangle{4, 4}, {1, 1}, {}})};
  return b;
}
double detected(const Beamline& b) { return run_points({b}).detectors.at(0).detected.at(0); }

TEST(Chopper, PassesItsOpenFractionOfALongPulse) {
  const double open = 0.3;
  Beamline b = through({open, frequency, 0.7});
  b.source.pulse = RectanglePulse{200 / frequency};
  b.particles = 2000000;
  expect_agreement(
      detected(b), [&](double scale) { return open * scale; }, 0.00098, "open fraction");  // 3 sigma
}

TEST(Chopper, OpensAndClosesWhenItsPhaseSays) {
  // At t = 0.5 ms the chopper has turned 1.5 times: with a lead of half a period it has just opened.
  const double open = 0.2, turn = two_pi, arrival = frequency * at / speed;
  const auto lead = [&](double into) { return turn * (into - arrival + std::floor(arrival) + 1); };
  for (const double into : {0.001, 0.1, 0.199})
    EXPECT_EQ(detected(through({open, frequency, lead(into)})), 1);
  for (const double into : {0.201, 0.5, 0.999})
    EXPECT_EQ(detected(through({open, frequency, lead(into)})), 0);
}

TEST(Chopper, TellsSpeedsApartByTheirTimeOfFlight) {
  // Open from 1.500 to 1.515 periods after the start: 1000 m/s comes at once, what is 1 % slower on the edge.
  const Chopper part{0.015, frequency, pi};
  EXPECT_EQ(detected(through(part, speed * (1 - 1e-6))), 1);
  EXPECT_EQ(detected(through(part, speed * 1.001)), 0);
  EXPECT_EQ(detected(through(part, speed / 1.0099)), 1);
  EXPECT_EQ(detected(through(part, speed / 1.0101)), 0);
}

TEST(Chopper, StopsWhatItDoesNotPass) {
  const Result r = run_points({through({0.4, frequency, 0})});
  for (const FateResult& f : r.fates)
    if (f.where == "chopper") {
      EXPECT_EQ(f.fate, "stopped");
      EXPECT_EQ(f.particles.at(0), 64);
    }
}

}  // namespace
}  // namespace rabiline::test::chopper_test
