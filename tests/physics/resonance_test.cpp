// Standard physics of driven spins through the whole program: source, fields, detector, levels.
#include <gtest/gtest.h>

#include <cmath>

#include "constants.hpp"
#include "physics/agreement.hpp"
#include "physics/suggested.hpp"

namespace rabiline::test::resonance_test {
namespace {

constexpr double speed = 1000, zone_length = 0.2, stay = zone_length / speed;
constexpr double field = 10e-3;

Species species_of(int twice_spin, double gamma) { return {"test", 1.67e-27, 0, {twice_spin}, gamma, ""}; }

RotatingField drive(double amplitude, double frequency) {
  RotatingField h0;
  h0.length = zone_length;
  h0.amplitude = amplitude;
  h0.frequency = frequency;
  h0.sense = Sense::co;
  return h0;
}

/// Polarizer, B from 0.3 m on, one zone of H0 or two with a gap, a wide detector; particles of one speed.
Beamline one_zone(const Species& species, double amplitude, double frequency) {
  Beamline b = suggested(frequency, amplitude);
  b.law = QuantumLaw{};
  b.species = {{species, 1}};
  b.source.speed = SingleSpeed{speed};
  b.particles = 64;
  b.parts = {place("P", 0.10, Polarizer{0.10, field, 1, {}}), place("B", 0.30, UniformField{0.7, field, {}}),
             place("H0", 0.35, drive(amplitude, frequency)),
             place("screen", 1.2, Detector{Rectangle{1, 1}, {1, 1}, {}})};
  return b;
}
Beamline two_zones(double amplitude, double frequency, double gap, double phase) {
  Beamline b = one_zone(neutron(), amplitude, frequency);
  RotatingField second = drive(amplitude, 0);
  second.frequency.reset();
  second.sense.reset();
  second.oscillator = "H0";
  second.phase = {Phase::Kind::angle, phase};
  b.parts.insert(b.parts.end() - 1, place("H1", 0.35 + zone_length + gap, second));
  return b;
}

/// Population of each level at the detector.
std::vector<double> levels(const Beamline& b) { return run_points({b}).detectors.at(0).levels; }

/// A polarised neutron has its moment along +z, so its spin starts in m = -1/2.
double flip(const Beamline& b) { return levels(b).at(0); }

/// S1: P = (w1/Omega)^2 sin^2(Omega t/2), Rabi 1937.
double rabi(double w1, double delta, double t) {
  const double omega = std::hypot(w1, delta);
  return omega == 0 ? 0 : std::pow(w1 / omega * std::sin(omega * t / 2), 2);
}

const double larmor = std::abs(gamma_n) * field / two_pi;
const double pi_pulse = pi / stay / std::abs(gamma_n);  // H0 of a pi pulse [T]

TEST(RotatingField, FlipsTheSpinByRabisFormulaOnAndOffResonance) {
  for (const double offset : {0.0, 700.0, -1900.0, 4000.0, -25000.0}) {
    const double w1 = 0.7 * pi / stay, b1 = w1 / std::abs(gamma_n);
    const double result = flip(one_zone(neutron(), b1, larmor + offset));
    if (offset == 0 || offset == -1900)
      expect_agreement(
          result, [&](double s) { return rabi(s * w1, two_pi * offset, stay); }, 1e-9, "in w1");
    if (offset != 0)
      expect_agreement(
          result, [&](double s) { return rabi(w1, s * two_pi * offset, stay); }, 1e-9, "in the detuning");
    EXPECT_NEAR(result, rabi(w1, two_pi * offset, stay), 1e-9);
  }
}

TEST(RotatingField, OfAPiPulseHasRabisWidthZeroAndSidelobe) {
  const auto at = [](double delta_nu_t) {
    return flip(one_zone(neutron(), pi_pulse, larmor + delta_nu_t / stay));
  };
  EXPECT_NEAR(at(0), 1, 1e-9);
  EXPECT_NEAR(at(0.79869 / 2), 0.5, 1e-4);
  EXPECT_GT(std::abs(at(1.01 * 0.79869 / 2) - 0.5), 1e-3);
  EXPECT_NEAR(at(0.8660254), 0, 1e-9);
  EXPECT_GT(at(1.01 * 0.8660254), 1e-5);
  EXPECT_NEAR(at(1.340), 0.11644, 1e-5);
  EXPECT_GT(std::abs(at(1.01 * 1.340) - 0.11644), 1e-5);
}

TEST(RotatingField, OfNoSizeOrOfTheWrongSenseLeavesTheLevelAlone) {
  EXPECT_EQ(flip(one_zone(neutron(), 0, larmor)), 0);
  Beamline counter = one_zone(neutron(), pi_pulse, larmor);
  std::get<RotatingField>(counter.parts[2].part).sense = Sense::counter;
  EXPECT_LT(flip(counter), 1e-3);
  EXPECT_GT(flip(counter), 0);
}

TEST(RotatingField, GivesTheSameFlipForEitherSignOfGammaBecauseCoFollowsIt) {
  const double plus = levels(one_zone(species_of(1, -gamma_n), 0.4 * pi_pulse, larmor + 900)).at(1);
  EXPECT_NEAR(plus, flip(one_zone(neutron(), 0.4 * pi_pulse, larmor + 900)), 1e-11);
}

/// S8: Ramsey 1950.
double ramsey(double w1, double delta, double tau, double gap, double phase) {
  const double a = std::hypot(w1, delta), sine = w1 / a, cosine = delta / a;
  const double half = (delta * gap + phase) / 2;
  return 4 * std::pow(sine * std::sin(a * tau / 2), 2) *
         std::pow(std::cos(half) * std::cos(a * tau / 2) - cosine * std::sin(half) * std::sin(a * tau / 2),
                  2);
}

TEST(TwoZones, OfOneOscillatorGiveRamseysFringes) {
  const double gap = 0.25, w1 = 0.5 * pi / stay;
  for (const double offset : {100.0, 450.0, -800.0, 2300.0}) {
    const double result = flip(two_zones(w1 / std::abs(gamma_n), larmor + offset, gap, 0));
    for (const char* what : {"detuning", "w1", "gap"})
      expect_agreement(
          result,
          [&](double s) {
            return ramsey((*what == 'w' ? s : 1) * w1, (*what == 'd' ? s : 1) * two_pi * offset, stay,
                          (*what == 'g' ? s : 1) * gap / speed, 0);
          },
          1e-9, what);
  }
}

TEST(TwoZones, WithAPhaseBetweenThemMoveTheFringeByThatPhase) {
  const double gap = 0.25, w1 = 0.5 * pi / stay;
  for (const double phase : {0.6, -1.5}) {
    const double result = flip(two_zones(w1 / std::abs(gamma_n), larmor + 450, gap, phase));
    // The neutron's co field turns right-handed: a phase ahead acts like a larger detuning during the gap.
    expect_agreement(
        result, [&](double s) { return ramsey(w1, two_pi * 450, stay, gap / speed, s * phase); }, 1e-9,
        "phase");
  }
}

TEST(TwoZones, OfOneOscillatorKeepTheirFringesWhenItsPhaseIsRandom) {
  const double gap = 0.25, w1 = 0.5 * pi / stay;
  Beamline b = two_zones(w1 / std::abs(gamma_n), larmor + 450, gap, 0);
  std::get<RotatingField>(b.parts[2].part).phase = {Phase::Kind::random, 0};
  EXPECT_NEAR(flip(b), ramsey(w1, two_pi * 450, stay, gap / speed, 0), 1e-9);
}

TEST(TwoZones, OfTwoOscillatorsWithRandomPhasesLoseTheirFringes) {
  const double gap = 0.25, w1 = 0.5 * pi / stay;
  Beamline b = one_zone(neutron(), w1 / std::abs(gamma_n), larmor);
  RotatingField second = drive(w1 / std::abs(gamma_n), larmor);
  second.phase = {Phase::Kind::random, 0};
  b.parts.insert(b.parts.end() - 1, place("H1", 0.35 + zone_length + gap, second));
  b.particles = 20000;
  const double p = 0.5;  // of one pi/2 pulse; two incoherent ones give 2p(1-p), with spread sin(phase)/2
  EXPECT_NEAR(flip(b), 2 * p * (1 - p), 4 * std::sqrt(0.125 / 20000));
}

TEST(FieldsThatOverlap, TurningAtTwoRatesActTogether) {
  // Two halves of one field are one field; a second one far off resonance goes through the stepped path.
  const double b1 = 0.6 * pi_pulse;
  Beamline halves = one_zone(neutron(), b1 / 2, larmor + 900);
  halves.parts.insert(halves.parts.end() - 1, place("again", 0.35, drive(b1 / 2, larmor + 900)));
  EXPECT_NEAR(flip(halves), rabi(0.6 * pi / stay, two_pi * 900, stay), 1e-5);
}

TEST(FieldsThatOverlap, SharesOutEveryLevelOfParticlesOfAnySpeed) {
  Beamline b = one_zone(neutron(), 80e-6, larmor);
  RotatingField counter = drive(80e-6, larmor);
  counter.sense = Sense::counter;
  b.parts.insert(b.parts.end() - 1, place("counter", 0.35, counter));
  b.source.speed = GaussianSpeed{1000, 500};
  b.particles = 4000;
  for (const Law& law : {Law{QuantumLaw{}}, Law{ClassicalLaw{}}}) {
    b.law = law;
    const std::vector<double> found = levels(b);
    EXPECT_NEAR(found[0] + found[1], 1, 1e-12);
    // The counter-rotating field is far off resonance: Rabi's formula over the speeds, cut at zero.
    double expected = 0, norm = 0;
    for (double v = 1; v < 4000; v += 1) {
      const double weight = std::exp(-0.5 * std::pow((v - 1000) / 500, 2));
      expected += weight * rabi(std::abs(gamma_n) * 80e-6, 0, zone_length / v);
      norm += weight;
    }
    EXPECT_NEAR(found[0], expected / norm, 4 * 0.4 / std::sqrt(4000) + 0.003);
  }
}

/// S10: Majorana 1932, P(m -> m') = |d^I|^2 for flip probability p of a spin 1/2.
TEST(SpinThreeHalves, SharesItsLevelsByMajoranasFormula) {
  const double gamma = two_pi * 16.54828e6, w1 = 2 * std::asin(0.5) / stay;  // p = 1/4 on resonance
  const auto at = [&](double scale) {
    return levels(one_zone(species_of(3, gamma), scale * w1 / gamma, gamma * field / two_pi));
  };
  const std::vector<double> result = at(1), off = at(1.01), expected{.421875, .421875, .140625, .015625};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(result[k], expected[k], 1e-9);
    EXPECT_GT(std::abs(off[k] - expected[k]), 1e-6) << "a field off by 1 % must show";
  }
}

TEST(AllLaws, GiveTheSameMeanSpinInHomogeneousFields) {
  for (const double offset : {0.0, 1500.0}) {
    Beamline b = one_zone(neutron(), 0.5 * pi_pulse, larmor + offset);
    const double quantum = flip(b);
    b.law = ClassicalLaw{};
    EXPECT_NEAR(flip(b), quantum, 1e-9);
    b.law = DoradoLaw{Closure::torque, 0};
    EXPECT_NEAR(flip(b), quantum, 1e-9);
  }
}

}  // namespace
}  // namespace rabiline::test::resonance_test
