// Atoms in their levels through the whole program: resonances, the caesium clock, ovens.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "constants.hpp"
#include "physics/agreement.hpp"
#include "physics/atoms.hpp"
#include "rules/rules.hpp"
#include "spin/atoms.hpp"

namespace rabiline::test::atoms_test {
namespace {

// ---- Zeeman resonances in a weak field ----

/// E/h = g mu_B m B/h in a weak field: the frequency per tesla of neighbouring m.
double zeeman(const char* atom, int twice_f) {
  const HyperfineAtom& a = *find_atom(atom);
  const double i = a.twice_i / 2.0, f = twice_f / 2.0, j = 0.5;
  const double of_j = (f * (f + 1) + j * (j + 1) - i * (i + 1)) / (2 * f * (f + 1));
  return (a.g_j * of_j + a.g_i * (1 - of_j)) * bohr_magneton / planck;
}
double binomial(int n, int k) {
  return std::round(std::tgamma(n + 1) / std::tgamma(k + 1) / std::tgamma(n - k + 1));
}

/// In 1 uT the levels of one F are evenly spaced but for 1 Hz: Majorana's spin F from its highest level.
void expect_flop(const char* atom, int f, Sense sense, double detuning) {
  const double field = 1e-6, speed = 600, length = 1.2, angle = 1.2;
  const double per_tesla = zeeman(atom, 2 * f), line = std::abs(per_tesla) * field;
  const double amplitude = angle * speed / length / (two_pi * std::abs(per_tesla));
  Beamline b = atoms(std::string(atom) + " atom", speed, in_level(f, f));
  b.parts = {place("C", 0.1, UniformField{length, field, {}}),
             place("R", 0.1, turning(length, amplitude, line + detuning, sense)), wide_screen(2)};
  const std::vector<double> found = levels_of(b);
  const bool drives = (sense == Sense::positive) == (per_tesla > 0);
  const HyperfineAtom& a = *find_atom(atom);
  const int first = 2 * f > a.twice_i ? 0 : a.twice_i + 2;  // (f, m = f) in the order of levels
  if (!drives) {
    EXPECT_GT(found[static_cast<std::size_t>(first)], 0.999) << atom << " F=" << f;
    return;
  }
  for (int k = 0; k <= 2 * f; ++k)
    EXPECT_NEAR(
        found[static_cast<std::size_t>(first + k)],
        [&] {
          const double p = rabi(two_pi * std::abs(per_tesla) * amplitude, two_pi * detuning, length / speed);
          return binomial(2 * f, k) * std::pow(p, k) * std::pow(1 - p, 2 * f - k);
        }(),
        2e-3)
        << atom << " F=" << f << " down by " << k;
  // The turning angle to 1 %.
  expect_agreement(
      found[static_cast<std::size_t>(first)],
      [&](double scale) {
        const double p =
            rabi(scale * two_pi * std::abs(per_tesla) * amplitude, two_pi * detuning, length / speed);
        return std::pow(1 - p, 2 * f);
      },
      2e-3, atom);
}

TEST(ZeemanResonance, OfHydrogenIsAFlopOfSpinOneInThePositiveSense) {
  EXPECT_GT(zeeman("H", 2), 0);
  for (const double detuning : {0.0, 150.0}) expect_flop("H", 1, Sense::positive, detuning);
  expect_flop("H", 1, Sense::negative, 0);
}

TEST(ZeemanResonance, OfTheTwoHyperfineLevelsHasOppositeSenses) {
  for (const char* atom : {"Na-23", "Rb-87", "K-39"}) {
    EXPECT_GT(zeeman(atom, 4), 0);
    EXPECT_LT(zeeman(atom, 2), 0);
    for (const Sense sense : {Sense::positive, Sense::negative}) {
      expect_flop(atom, 2, sense, 30);
      expect_flop(atom, 1, sense, 30);
    }
  }
}

TEST(ZeemanResonance, DoesNotReachTheOtherHyperfineLevel) {
  Beamline b = atoms("H atom", 600, in_level(0, 0));
  b.parts = {place("C", 0.1, UniformField{1, 1e-6, {}}),
             place("R", 0.1, turning(1, 0.02e-6, 14e3, Sense::positive)), wide_screen(2)};
  EXPECT_NEAR(levels_of(b).at(3), 1, 1e-9);
}

TEST(ZeemanResonance, OfAFieldThatSwingsIsThatOfItsTurningHalf) {
  const double field = 1e-6, speed = 600, line = zeeman("H", 2) * field,
               amplitude = 2 * 1.2 * speed / (two_pi * zeeman("H", 2));
  const auto stays = [&](UnitVector direction) {
    Beamline b = atoms("H atom", speed, in_level(1, 1));
    OscillatingField rf = swinging(1, amplitude, line + 40);
    rf.direction = direction;
    b.parts = {place("C", 0.1, UniformField{1, field, {}}), place("R", 0.1, rf), wide_screen(2)};
    return levels_of(b).at(0);
  };
  for (const UnitVector& direction : {UnitVector{1, 0, 0}, UnitVector{0, 1, 0}, UnitVector{0.6, 0, 0.8}})
    expect_agreement(
        stays(direction),
        [&](double scale) {
          const double w1 =
              scale * two_pi * zeeman("H", 2) * amplitude / 2 * std::hypot(direction.x, direction.y);
          return std::pow(1 - rabi(w1, two_pi * 40, 1 / speed), 2);
        },
        3e-3, "swings");
}

TEST(ZeemanResonance, OfAProfileTurnsByItsArea) {
  const double field = 1e-6, speed = 600, length = 0.8, sigma = 0.1, w1 = 2000;
  const double per_tesla = zeeman("H", 2);
  const auto stays = [&](const DriveProfile& profile) {
    Beamline b = atoms("H atom", speed, in_level(1, 1));
    RotatingField rf = turning(length, w1 / (two_pi * per_tesla), per_tesla * field, Sense::positive);
    rf.profile = profile;
    b.parts = {place("C", 0.1, UniformField{1, field, {}}), place("R", 0.2, rf), wide_screen(2)};
    return levels_of(b).at(0);
  };
  const auto expected = [&](double area) {
    return [=](double scale) { return std::pow(std::cos(scale * w1 * area / speed / 2), 4); };
  };
  expect_agreement(stays(HalfSineProfile{}), expected(2 * length / pi), 3e-3, "half sine");
  expect_agreement(stays(GaussianProfile{sigma}),
                   expected(sigma * std::sqrt(two_pi) * std::erf(length / 2 / sigma / std::sqrt(2.0))), 3e-3,
                   "gaussian");
}

// ---- the caesium clock ----

/// Ramsey's zones of one oscillator for (4,0)-(3,0), fields along z as the C field.
struct Clock {
  double field = 100e-6, speed = 200, first = 0.02, second = 0.02, gap = 0.4;  // [T] [m/s] [m]
  double first_angle = pi / 2, second_angle = pi / 2, power = 1, phase = 0;
  double field_in_first_half = 0, field_in_second_half = 0, more_in_first_zone = 0;  // [T]
  std::optional<double> oven{};                                                      // [K]
  std::uint64_t particles = 8;
};
constexpr double clock_line = 9192631770.0, clock_shift = 427.45e8;  // [Hz] [Hz/T^2]

/// Turning angle per tesla and second: (g_J - g_I') mu_B A/(2 hbar), the half that turns of <4,0|mu_z|3,0>.
double clock_rate() {
  const HyperfineAtom& cs = *find_atom("Cs-133");
  return (cs.g_j - cs.g_i) * bohr_magneton / (2 * hbar);
}

Beamline clock_at(const Clock& c, double frequency) {
  const double begin = 0.1, middle = begin + c.first, end = middle + c.gap;
  Beamline b = atoms("Cs-133 atom", c.speed, in_level(4, 0));
  if (c.oven) b.source.speed = EffusiveSpeed{*c.oven};
  b.particles = c.particles;
  const auto zone = [&](double length, double angle) {
    OscillatingField rf = swinging(length, c.power * angle * c.speed / length / clock_rate(), {});
    rf.direction = {0, 0, 1};
    return rf;
  };
  OscillatingField first = zone(c.first, c.first_angle), second = zone(c.second, c.second_angle);
  first.frequency = frequency;
  first.phase = {Phase::Kind::random, 0};
  second.oscillator = "first";
  second.phase = {Phase::Kind::angle, c.phase};
  const double one = c.field_in_first_half, two = c.field_in_second_half;
  b.parts = {place("C", begin, UniformField{c.first + c.gap + c.second, c.field, {}}),
             place("first", begin, first)};
  if (c.more_in_first_zone != 0)
    b.parts.push_back(place("more", begin, UniformField{c.first, c.more_in_first_zone, {}}));
  if (one != 0) {
    b.parts.push_back(place("one", middle, UniformField{c.gap / 2, one - c.field, {}}));
    b.parts.push_back(place("two", middle + c.gap / 2, UniformField{c.gap / 2, two - c.field, {}}));
  }
  b.parts.push_back(place("second", end, second));
  b.parts.push_back(wide_screen(1.2));
  return b;
}
/// What is found in (3,0).
double flips(const Clock& c, double offset) { return levels_of(clock_at(c, clock_line + offset)).at(9 + 3); }
/// The middle of the fringe about `near` [Hz], by equal heights on both sides.
double centre(const Clock& c, double near, double side = 60) {
  double low = near - side / 2, high = near + side / 2;
  for (int i = 0; i < 30; ++i) {
    const double middle = (low + high) / 2;
    (flips(c, middle + side) > flips(c, middle - side) ? low : high) = middle;
  }
  return (low + high) / 2;
}

TEST(CaesiumClock, TurnsByTheHalfOfItsFieldThatTurns) {
  const double line = clock_line + clock_shift * 1e-8;
  for (const double offset : {0.0, 1500.0}) {
    Clock c;
    c.second_angle = 0;
    expect_agreement(
        levels_of(clock_at(c, line + offset)).at(12),
        [&](double scale) { return rabi(scale * pi / 2 * 200 / 0.02, two_pi * offset, 0.02 / 200); }, 3e-4,
        "one zone");
  }
}

TEST(CaesiumClock, HasItsFringeAtTheSecondsLineAndTheQuadraticShift) {
  for (const double field : {10e-6, 50e-6, 100e-6}) {
    Clock c;
    c.field = field;
    const double shift = clock_shift * field * field;
    expect_agreement(
        centre(c, shift), [&](double scale) { return scale * shift; }, 5e-3 * shift, "one speed");
    EXPECT_NEAR(flips(c, shift), 1, 1e-6);
  }
}

TEST(CaesiumClock, OfAnOvenHasTheSameCentre) {
  Clock c;
  c.oven = 380;
  c.particles = 2000;
  c.power = 1.2;
  const double shift = clock_shift * 1e-8;
  expect_agreement(
      centre(c, shift), [&](double scale) { return scale * shift; }, 0.5, "oven");
}

TEST(CaesiumClock, FollowsAPhaseOfTheSecondZone) {
  // S8: phi/(2 pi (T + 4 tau/pi)), down for a phase ahead.
  Clock c;
  c.phase = 0.5;
  const double shift = clock_shift * 1e-8, time = c.gap / c.speed + 4 * c.first / c.speed / pi;
  expect_agreement(
      centre(c, shift - c.phase / (two_pi * time), 20) - shift,
      [&](double scale) { return -scale * c.phase / (two_pi * time); }, 0.25, "phase");
}

TEST(CaesiumClock, OfUnequalZonesTurnsByTheirSumAndStaysCentred) {
  Clock c;
  c.second = 0.05;
  c.first_angle = 0.5;
  c.second_angle = 1.2;
  const double shift = clock_shift * 1e-8;
  expect_agreement(
      flips(c, shift), [](double scale) { return std::pow(std::sin((scale * 0.5 + 1.2) / 2), 2); }, 1e-3,
      "angles");
  EXPECT_NEAR(centre(c, shift), shift, 0.1);
}

TEST(CaesiumClock, ChangesItsShapeAndNotItsCentreWithPower) {
  const double shift = clock_shift * 1e-8;
  Clock weak, strong;
  strong.power = 1.6;
  EXPECT_GT(std::abs(flips(weak, shift) - flips(strong, shift)), 0.05);
  EXPECT_NEAR(centre(strong, shift), centre(weak, shift), 0.1);
}

TEST(CaesiumClock, SeesTheMeanSquareOfTheFieldBetweenItsZones) {
  Clock even, uneven;
  uneven.field_in_first_half = 110e-6;
  uneven.field_in_second_half = std::sqrt(2e-8 - 1.21e-8);
  const double shift = clock_shift * 1e-8;
  for (const double offset : {0.0, 60.0, -250.0})
    EXPECT_NEAR(flips(uneven, shift + offset), flips(even, shift + offset), 1e-5) << offset;
  // Of equal mean field only it shifts by the variance.
  uneven.field_in_second_half = 90e-6;
  const double tau = even.first / even.speed, gap = even.gap / even.speed;
  expect_agreement(
      centre(uneven, shift + 4) - shift,
      [&](double scale) { return scale * clock_shift * 1e-10 * gap / (gap + 4 * tau / pi); }, 0.03,
      "variance");
}

TEST(CaesiumClock, SeesTheFieldInsideAZoneLessThanHalfItsPhase) {
  Clock uneven;
  uneven.more_in_first_zone = 20e-6;
  const double more = clock_shift * (1.44e-8 - 1e-8), shift = clock_shift * 1e-8;
  const double tau = uneven.first / uneven.speed, gap = uneven.gap / uneven.speed;
  const double moved = centre(uneven, shift + 5, 30) - shift;
  EXPECT_NEAR(moved, more * (2 * tau / pi) / (gap + 4 * tau / pi), 0.1);
  EXPECT_GT(moved, 3);
}

TEST(CaesiumClock, OfAPulsedBeamHasOneClockAndIsRefusedForTwo) {
  Clock c;
  Beamline b = clock_at(c, clock_line);
  const double still = levels_of(b).at(12);
  b.source.pulse = RectanglePulse{1e-3};
  EXPECT_NEAR(levels_of(b).at(12), still, 1e-9);
  auto& second = std::get<OscillatingField>(b.parts[2].part);
  second.oscillator.reset();
  second.frequency = clock_line + 400;
  std::get<OscillatingField>(b.parts[1].part).phase = {Phase::Kind::locked, 0};
  const std::vector<Fault> faults = faults_of(b);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].subject + "." + faults[0].key, b.parts[2].placement.name + ".phase");
  second.phase = {Phase::Kind::random, 0};
  EXPECT_TRUE(faults_of(b).empty());
  EXPECT_NO_THROW(levels_of(b));
}

// ---- ovens ----

TEST(ThermalSpin, FillsTheLevelsOfHydrogenByBoltzmann) {
  for (const double temperature : {0.05, 0.3}) {
    Beamline b = atoms("H atom", 600, ThermalSpin{temperature, 0});
    b.particles = 400000;
    b.parts = {wide_screen(1)};
    const Result r = run_points({b});
    const std::vector<double>& found = r.detectors.at(0).levels;
    const auto lowest = [&](double scale) {
      return 1 / (1 + 3 * std::exp(-planck * scale * 1420.405751768e6 / (boltzmann * temperature)));
    };
    const double tolerance = 4 * 0.5 / std::sqrt(4e5);
    if (temperature < 0.1)
      expect_agreement(found.at(3), lowest, tolerance, "F=0");
    else
      EXPECT_NEAR(found.at(3), lowest(1), tolerance);
    for (std::size_t m = 0; m < 3; ++m) EXPECT_NEAR(found[m], (1 - lowest(1)) / 3, tolerance);
    EXPECT_NEAR(r.emitted_by_level.at(3) / 4e5, found.at(3), 1e-12);
  }
}

// ---- directions ----

TEST(TiltedSource, OfAtomsFliesThroughAFieldAsSlowlyAsItsSpeedAlongTheBeam) {
  const double angle = pi / 6;
  Beamline tilted = atoms("K-39 atom", 600, in_level(2, 2));
  tilted.parts = {place("C", 0.25, UniformField{0.1, 1e-6, {}}),
                  place("R", 0.25, turning(0.1, 0.2e-6, 7e3, Sense::positive)),
                  place("screen", 1, Detector{Rectangle{4, 4}, {1, 1}, {}})};
  Beamline straight = tilted;
  tilted.source.tilt.x = angle;
  straight.source.speed = SingleSpeed{600 * std::cos(angle)};
  const std::vector<double> one = levels_of(tilted), other = levels_of(straight);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(one[i], other[i], 1e-5);
  EXPECT_GT(one[1], 0.1);
}

TEST(WideSource, OfAtomsSpendsInAFieldWhatEachDirectionNeeds) {
  // A cone of 40 degrees: the mean over c = cos, uniform.
  const double widest = 40 * pi / 180, speed = 600, length = 0.1, amplitude = 0.03e-6, field = 1e-6;
  const double per_tesla = zeeman("H", 2);
  Beamline b = atoms("H atom", speed, in_level(1, 1));
  b.source.direction = ConeDirection{widest};
  b.particles = 400000;
  b.parts = {place("C", 0.25, UniformField{length, field, {}}),
             place("R", 0.25, turning(length, amplitude * 10, per_tesla * field, Sense::positive)),
             place("screen", 1, Detector{Rectangle{4, 4}, {1, 1}, {}})};
  const auto expected = [&](double scale) {
    double sum = 0;
    const int steps = 2000;
    for (int i = 0; i < steps; ++i) {
      const double c = 1 - (i + 0.5) / steps * (1 - std::cos(widest));
      const double p = rabi(scale * two_pi * per_tesla * amplitude * 10, 0, length / speed / c);
      sum += std::pow(1 - p, 2) / steps;
    }
    return sum;
  };
  expect_agreement(levels_of(b).at(0), expected, 2.5e-3, "cone");
}

// ---- isotopes in one beam ----

TEST(MixedIsotopes, EachFlyAsTheyWouldAlone) {
  const auto beam = [](std::vector<Component> species, StartSpin spin) {
    Beamline b = atoms("K-39 atom", 500, std::move(spin));
    b.species = std::move(species);
    b.particles = 64;
    b.parts = {place("C", 0.1, UniformField{0.2, 10e-6, {}}),
               place("R", 0.15, turning(0.1, 0.15e-6, 461.79e6, Sense::positive)), wide_screen(1)};
    return b;
  };
  const Species &k39 = *find_species("K-39 atom"), &k41 = *find_species("K-41 atom");
  const std::vector<double> both = levels_of(beam({{k39, 0.75}, {k41, 0.25}}, in_level(1, 0))),
                            first = levels_of(beam({{k39, 1}}, in_level(1, 0))),
                            second = levels_of(beam({{k41, 1}}, in_level(1, 0)));
  ASSERT_EQ(both.size(), first.size() + second.size());
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_NEAR(both[k], 0.75 * first[k], 1e-9) << k;
    EXPECT_NEAR(both[first.size() + k], 0.25 * second[k], 1e-9) << k;
  }
  EXPECT_LT(first[6], 0.1);  // F=1 m=0 is driven in K-39 and not in K-41
  EXPECT_GT(second[6], 0.9999);
  // Of different nuclear spins.
  EXPECT_EQ(levels_of(beam(find_mixture("natural Li atom")->components, UnpolarisedSpin{})).size(), 6u + 8u);
}

}  // namespace
}  // namespace rabiline::test::atoms_test
