// What shifts a line or a fringe and what does not, with one speed: Ramsey's rules.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "constants.hpp"
#include "physics/agreement.hpp"
#include "physics/suggested.hpp"

namespace rabiline::test::ramsey_test {
namespace {

constexpr double speed = 1000, field = 10e-3;
const double larmor = std::abs(gamma_n) * field / two_pi;

/// Two zones of one oscillator in one field B with these lengths [m], turning angles on resonance and phase
/// of the second, and pieces of more field [T] between the zones.
struct Zones {
  double first = 0.02, second = 0.02, gap = 0.4;
  double first_angle = pi / 2, second_angle = pi / 2, phase = 0;
  double more_in_first_half = 0, more_in_second_half = 0, more_in_first_zone = 0;
  double power = 1;  // of the amplitude
};

double flip(const Zones& s, double offset) {
  const double begin = 0.3, middle = begin + s.first, end = middle + s.gap;
  const auto zone = [&](double length, double angle) {
    RotatingField part;
    part.length = length;
    part.amplitude = s.power * angle * speed / length / std::abs(gamma_n);
    return part;
  };
  RotatingField first = zone(s.first, s.first_angle), second = zone(s.second, s.second_angle);
  first.frequency = larmor + offset;
  first.sense = Sense::co;
  second.oscillator = "first";
  second.phase = {Phase::Kind::angle, s.phase};
  Beamline b = suggested(0);
  b.law = QuantumLaw{};
  b.source.speed = SingleSpeed{speed};
  b.chamber.reset();
  b.particles = 8;
  b.parts = {place("P", 0.1, Polarizer{0.05, field, 1, {}}),
             place("B", begin, UniformField{s.first + s.gap + s.second, field, {}}),
             place("first", begin, first)};
  if (s.more_in_first_zone != 0)
    b.parts.push_back(place("more", begin, UniformField{s.first, s.more_in_first_zone, {}}));
  if (s.more_in_first_half != 0) {
    b.parts.push_back(place("one", middle, UniformField{s.gap / 2, s.more_in_first_half, {}}));
    b.parts.push_back(place("two", middle + s.gap / 2, UniformField{s.gap / 2, s.more_in_second_half, {}}));
  }
  b.parts.push_back(place("second", end, second));
  b.parts.push_back(place("screen", 1.2, Detector{Rectangle{1, 1}, {1, 1}, {}}));
  return run_points({b}).detectors.at(0).levels.at(0);
}

/// Where the central fringe is highest [Hz]: its symmetric middle, by halving.
double centre(const Zones& s, double near, double reach = 60) {
  const auto slope = [&](double x) { return flip(s, x + 20) - flip(s, x - 20); };
  double low = near - reach, high = near + reach;
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2;
    (slope(middle) > 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

TEST(PowerOfTheField, ChangesTheShapeOfALineAndNotItsCentre) {
  Zones weak, strong;
  strong.power = 1.6;
  EXPECT_GT(std::abs(flip(weak, 300) - flip(strong, 300)), 0.05);
  for (const Zones& s : {weak, strong})
    for (const double offset : {90.0, 300.0, 2500.0}) EXPECT_NEAR(flip(s, offset), flip(s, -offset), 1e-9);
}

TEST(PhaseOfTheSecondZone, MovesTheFringeByItsPartOfATurnOverTheTimeBetween) {
  // S8: phase/(2 pi (T + 4 tau/pi)) with pi/2 zones. A phase ahead acts like a larger detuning: the fringe
  // goes down.
  const Zones s{.phase = 0.3};
  const double gap = s.gap / speed, tau = s.first / speed;
  expect_agreement(
      centre(s, -100), [&](double scale) { return -scale * s.phase / (two_pi * (gap + 4 * tau / pi)); }, 0.2,
      "pi/2 zones");
}

TEST(PhaseOfTheSecondZone, MovesTheFringeOfShortZonesByItsPartOfATurnOverTheTimeBetween) {
  const Zones s{.first = 1e-5, .second = 1e-5, .phase = 0.3};
  expect_agreement(
      centre(s, -119), [&](double scale) { return -scale * s.phase / (two_pi * s.gap / speed); }, 0.02,
      "short zones");
}

TEST(UnequalZones, TurnByTheSumOfTheirAnglesOnResonanceAndStayCentred) {
  const Zones s{.first = 0.02, .second = 0.05, .first_angle = 0.5, .second_angle = 1.2};
  expect_agreement(
      flip(s, 0), [](double scale) { return std::pow(std::sin((scale * 0.5 + 1.2) / 2), 2); }, 1e-9,
      "angles");
  for (const double offset : {70.0, 400.0, 1500.0}) EXPECT_NEAR(flip(s, offset), flip(s, -offset), 1e-9);
}

TEST(UnequalZones, HaveFringesOfTheContrastThatTheirAnglesAllow) {
  // At the fringe's foot the two turns oppose: sin^2((a1 - a2)/2), for zones short against the gap.
  const Zones s{.first = 1e-5, .second = 1e-5, .first_angle = 0.5, .second_angle = 1.2};
  const double foot = speed / s.gap / 2;
  EXPECT_NEAR(flip(s, foot), std::pow(std::sin(0.35), 2), 1e-4);
  EXPECT_GT(std::abs(flip(s, 1.05 * foot) - std::pow(std::sin(0.35), 2)), 1e-3);
}

TEST(FieldBetweenTheZones, OfEqualMeanDoesNotShiftTheFringe) {
  Zones uneven;
  uneven.more_in_first_half = 40e-6;
  uneven.more_in_second_half = -40e-6;
  for (const double offset : {0.0, 200.0, -700.0}) EXPECT_NEAR(flip(uneven, offset), flip({}, offset), 1e-9);
  uneven.more_in_second_half = -39e-6;
  EXPECT_GT(std::abs(flip(uneven, 200) - flip({}, 200)), 1e-3);
}

TEST(FieldInsideAZone, ShiftsTheFringeByMoreThanItsShareOfTheMean) {
  Zones uneven;
  uneven.more_in_first_zone = 20e-6;
  const double zone = std::abs(gamma_n) * 20e-6 / two_pi;  // by which its resonance is off [Hz]
  const double shift = centre(uneven, 20);
  // Half of 4 tau/pi of the phase is taken up in each pi/2 zone.
  const double tau = uneven.first / speed, gap = uneven.gap / speed;
  EXPECT_NEAR(shift, zone * (2 * tau / pi) / (gap + 4 * tau / pi), 1.0);
  EXPECT_GT(shift, 15);
}

/// The mean over the flux of an oven, 2 y^3 exp(-y^2) with y = v/alpha, by Simpson's rule.
double over_flux(const std::function<double(double y)>& f) {
  constexpr int steps = 20000;
  constexpr double high = 6;
  double sum = 0;
  for (int i = 1; i < steps; ++i) {
    const double y = high * i / steps;
    sum += (i % 2 == 1 ? 4 : 2) * 2 * y * y * y * std::exp(-y * y) * f(y);
  }
  return sum * high / steps / 3;
}

TEST(TwoZones, OfAnEffusiveBeamGiveTheMeanOfRamseysFringesOverTheFlux) {
  Beamline b = suggested(0);
  b.law = QuantumLaw{};
  b.source.speed = EffusiveSpeed{60};
  b.chamber.reset();
  b.particles = 1000000;
  const double alpha = std::sqrt(2 * boltzmann * 60 / b.species[0].species.mass), l = 0.05, gap = 0.5;
  const double w1 = 0.6 * pi * alpha / l;
  RotatingField first, second;
  first.length = second.length = l;
  first.amplitude = second.amplitude = w1 / std::abs(gamma_n);
  first.sense = Sense::co;
  second.oscillator = "first";
  for (const double offset : {0.0, 300.0, 600.0, 1100.0, 2500.0}) {
    first.frequency = larmor + offset;
    b.parts = {place("P", 0.1, Polarizer{0.05, field, 1, {}}), place("B", 0.3, UniformField{0.7, field, {}}),
               place("first", 0.35, first), place("second", 0.35 + l + gap, second),
               place("screen", 1.2, Detector{Rectangle{1, 1}, {1, 1}, {}})};
    // S8 at each speed.
    const auto expected = [&](double scale) {
      return over_flux([&](double y) {
        const double v = y * alpha, tau = l / v, time = gap / v, delta = scale * two_pi * offset;
        const double drive = scale * w1, a = std::hypot(drive, delta), sine = drive / a, cosine = delta / a;
        return 4 * std::pow(sine * std::sin(a * tau / 2), 2) *
               std::pow(std::cos(delta * time / 2) * std::cos(a * tau / 2) -
                            cosine * std::sin(delta * time / 2) * std::sin(a * tau / 2),
                        2);
      });
    };
    EXPECT_NEAR(run_points({b}).detectors.at(0).levels.at(0), expected(1), 4 * 0.4 / std::sqrt(1e6))
        << offset;
    if (offset == 600) {
      EXPECT_GT(std::abs(expected(1.01) - expected(1)), 4 * 0.4 / std::sqrt(1e6));
    }
  }
}

TEST(NeighbouringLine, InTheSameFieldPullsTheLine) {
  // A second oscillator nearby drives the spin as well: the line is no longer even about its centre.
  Beamline b = suggested(larmor, 0.3 * pi / 2e-4 / std::abs(gamma_n));
  b.law = QuantumLaw{};
  b.source.speed = SingleSpeed{speed};
  b.particles = 256;
  RotatingField other = std::get<RotatingField>(b.parts[2].part);
  other.frequency = larmor + 6000;
  other.phase = {Phase::Kind::random, 0};
  b.parts.insert(b.parts.begin() + 3, place("other", 0.35, other));
  const auto at = [&](double offset) {
    std::get<RotatingField>(b.parts[2].part).frequency = larmor + offset;
    return run_points({b}).detectors.at(0).levels.at(0);
  };
  EXPECT_GT(std::abs(at(2000) - at(-2000)), 0.008);
}

}  // namespace
}  // namespace rabiline::test::ramsey_test
