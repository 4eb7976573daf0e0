// Steps that carry spins through fields without a closed form keep the law's tolerance, against an
// independent integration.
#include <gtest/gtest.h>

#include <cmath>

#include "constants.hpp"
#include "physics/agreement.hpp"
#include "physics/independent_spin.hpp"
#include "physics/suggested.hpp"
#include "rules/rules.hpp"
#include "simulation/trace.hpp"

namespace rabiline::test::spin_steps_test {
namespace {

constexpr double speed = 1000, begin = 0.3, length = 0.2, entered = begin / speed, stay = length / speed;
constexpr double turns = 400, field = turns / stay * two_pi / -gamma_n;  // of the precession

/// Neutrons of one speed, S = -z, that turn 400 times in a drive.
Beamline line(Part drive, const Law& law, int twice_spin = 1) {
  Beamline b = suggested(0);
  b.law = law;
  b.species.front().species.spin.twice = twice_spin;
  b.source.speed = SingleSpeed{speed};
  b.source.opening = Disc{0};
  b.chamber.reset();
  b.particles = 8;
  b.parts = {place("P", 0.1, Polarizer{0.05, 1e-3, 1, {}}), place("B", begin, UniformField{0.6, field, {}}),
             place("H0", begin, std::move(drive)),
             place("screen", 1.2, Detector{Rectangle{1, 1}, {1, 1}, {}})};
  return b;
}
/// A quarter as strong as the static field, near its resonance all along.
OscillatingField swept_field() {
  OscillatingField part;
  part.length = length;
  part.amplitude = field / 4;
  part.frequency = turns / stay;
  part.approximation = Approximation::none;
  part.phase = {Phase::Kind::angle, 0.7};
  part.sweep = FrequencySweep{1.02 * turns / stay, entered, entered + stay};
  return part;
}
/// Off resonance, and as strong as the static field where it is strongest.
RotatingField swelling_field() {
  RotatingField part;
  part.length = length;
  part.amplitude = field;
  part.frequency = 0.7 * turns / stay;
  part.sense = Sense::co;
  part.phase = {Phase::Kind::angle, 0.7};
  part.profile = StandingWaveProfile{60, WaveEnds::nodes};
  return part;
}
double integrated(const FieldInTime& at) {
  return spin_after(gamma_n, at, entered, entered + stay, {0, 0, -1})[2];
}
double swept_sz() {
  const OscillatingField part = swept_field();
  const double rate = (part.sweep->to - *part.frequency) / stay;
  return integrated([&](double t) {
    const double in = t - entered, angle = two_pi * (*part.frequency * t + rate * in * in / 2) + 0.7;
    return Vec{part.amplitude * std::cos(angle), 0, field};
  });
}
double swelling_sz() {
  const RotatingField part = swelling_field();
  return integrated([&](double t) {
    const double size = part.amplitude * std::sin(60 * pi * (t - entered) / stay),
                 angle = two_pi * *part.frequency * t + 0.7;
    return Vec{size * std::cos(angle), size * std::sin(angle), field};
  });
}
double flipped(const Beamline& b) { return run_points({b}).detectors.at(0).levels.at(0); }

TEST(SpinSteps, KeepTheToleranceOverHundredsOfTurns) {
  const double swept = swept_sz(), swelling = swelling_sz();
  for (const double tolerance : {1e-6, 1e-8}) {
    EXPECT_NEAR(2 * flipped(line(swept_field(), ClassicalLaw{tolerance})) - 1, swept, tolerance);
    EXPECT_NEAR(2 * flipped(line(swelling_field(), ClassicalLaw{tolerance})) - 1, swelling, tolerance);
    QuantumLaw quantum;
    quantum.tolerance = tolerance;
    EXPECT_NEAR(2 * flipped(line(swept_field(), quantum)) - 1, swept, tolerance);
  }
}

TEST(SpinSteps, OfATracedParticleKeepTheTolerance) {
  const double swept = swept_sz(), swelling = swelling_sz();
  for (const double tolerance : {1e-6, 1e-8}) {
    const ClassicalLaw law{tolerance};
    EXPECT_NEAR(trace(line(swept_field(), law), 0, best_isa()).sz.back(), swept, tolerance);
    EXPECT_NEAR(trace(line(swelling_field(), law), 0, best_isa()).sz.back(), swelling, tolerance);
  }
}

TEST(SpinSteps, KeepTheToleranceOfTenLevels) {
  const double up = (1 + swept_sz()) / 2;
  const Beamline b = line(swept_field(), QuantumLaw{}, 9);
  const std::vector<double> levels = run_points({b}).detectors.at(0).levels;
  double choose = 1;
  for (int down = 0; down <= 9; ++down) {
    EXPECT_NEAR(levels.at(static_cast<std::size_t>(down)),
                choose * std::pow(up, 9 - down) * std::pow(1 - up, down), 1e-6);
    choose *= static_cast<double>(9 - down) / (down + 1);
  }
}

// Off the axis of a gradient along the beam a spin turns many times, in one step, about a direction that
// hardly changes: halves of a step are then off by as much as the whole.
TEST(SpinSteps, OfManyTurnsKeepTheTolerance) {
  UniformField guide{3, 1e-3, {}};
  guide.gradient.longitudinal = 1e-4;
  Beamline b = suggested(0);
  b.law = QuantumLaw{};
  b.source.speed = GaussianSpeed{1000, 25};
  b.source.opening = Rectangle{2e-3, 1e-2};
  b.source.direction = GaussianDirection{1e-3, 1e-3};
  b.particles = 2000;
  b.parts = {place("P", 0.1, SpinFilter{}), place("guide", 0.3, guide),
             place("screen", 3.5, Detector{Rectangle{1, 1}, {1, 1}, {}})};
  const auto check = check_of(b);
  ASSERT_TRUE(check);
  EXPECT_GT(check->spin, 1e-12);
  EXPECT_LT(check->spin, 1e-6);
}

TEST(SpinSteps, ThatWouldBeTooManyAreRefused) {
  Beamline b = line(swept_field(), ClassicalLaw{1e-10});
  auto& swept = std::get<OscillatingField>(b.parts.at(2).part);
  for (double* size : {&swept.amplitude, &*swept.frequency, &swept.sweep->to}) *size *= 2e3;
  std::get<UniformField>(b.parts.at(1).part).field *= 2e3;
  const auto faults = faults_of({b});
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults.front().subject, "H0");
  EXPECT_NE(faults.front().message.find(
                "to keep the law's tolerance of 1e-10, and 1e+08 are the most in one field"),
            std::string::npos)
      << faults.front().message;
}

}  // namespace
}  // namespace rabiline::test::spin_steps_test
