// Sources through whole runs: what aimed ones stand for, and what becomes of prepared spins.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "physics/suggested.hpp"

namespace rabiline::source_test {
namespace {

using test::place;
using test::run_points;
using test::suggested;

constexpr double pi = std::numbers::pi;

/// A slit and a screen behind it that sees a part of what passes.
Beamline through_a_slit(DirectionLaw direction) {
  Beamline b = suggested(291e3);
  b.law = QuantumLaw{};
  b.source = {SingleSpeed{1000}, Disc{0.2e-3}, std::move(direction)};
  b.chamber.reset();
  b.parts = {place("S", 0.004, Slit{Rectangle{1e-3, 2e-3}, {0.7e-3, 0}}),
             place("screen", 0.008, Detector{Rectangle{2e-3, 3e-3}, {1, 1}, {}})};
  b.particles = 2000000;
  return b;
}
/// Detected share of all that leave the source, and its error.
std::pair<double, double> detected_share(const Beamline& b) {
  const Result r = run_points({b});
  const double fraction = r.aimed_fraction.empty() ? 1 : r.aimed_fraction.at(0);
  const double scale = r.emitted[0] / static_cast<double>(r.particles) * fraction;
  return {r.detectors[0].detected[0] * scale, r.detectors[0].detected_errors[0] * scale};
}

void expect_aimed_like_unaimed(const DirectionLaw& whole, const EmissionLaw& emission) {
  const auto [all, error] = detected_share(through_a_slit(whole));
  const auto [aimed, aimed_error] = detected_share(through_a_slit(AimedDirection{"S", emission}));
  const double bound = 4 * std::hypot(error, aimed_error);
  EXPECT_NEAR(aimed, all, bound);
  EXPECT_GT(std::abs(1.05 * aimed - all), bound);
  EXPECT_LT(aimed_error, error);
}

TEST(AimedFraction, MakesAnAimedRunAgreeWithAnIsotropicOne) {
  expect_aimed_like_unaimed(ConeDirection{pi / 2 - 1e-9}, IsotropicEmission{});
}
TEST(AimedFraction, MakesAnAimedRunAgreeWithACosineOne) {
  expect_aimed_like_unaimed(CosineDirection{}, CosineEmission{});
}
TEST(AimedFraction, MakesAnAimedRunAgreeWithAChannel) {
  expect_aimed_like_unaimed(ChannelDirection{6e-3, 2e-3}, ChannelDirection{6e-3, 2e-3});
}
TEST(AimedFraction, MakesAnAimedRunAgreeWithATiltedOne) {
  Beamline whole = through_a_slit(CosineDirection{pi / 2 - 0.41});
  Beamline aimed = through_a_slit(AimedDirection{"S", CosineEmission{}});
  whole.source.tilt = aimed.source.tilt = {0.4, 0};
  // The limit leaves sin^2 of all.
  auto [all, error] = detected_share(whole);
  const double kept = std::pow(std::sin(pi / 2 - 0.41), 2);
  all *= kept, error *= kept;
  const auto [share, aimed_error] = detected_share(aimed);
  EXPECT_NEAR(share, all, 4 * std::hypot(error, aimed_error));
}

TEST(DetectedOfAll, IsTheFractionOfAllThatLeaveWithItsError) {
  const Result r = run_points({through_a_slit(AimedDirection{"S", CosineEmission{}})});
  const double scale = r.aimed_fraction[0] * r.emitted[0] / static_cast<double>(r.particles);
  EXPECT_LT(scale, 0.99 * r.aimed_fraction[0]);  // weights are below 1
  EXPECT_DOUBLE_EQ(r.detectors[0].detected_of_all[0], scale * r.detectors[0].detected[0]);
  // The scatter of the emitted weights is in it, of which the fraction knows nothing.
  const double of_fraction = scale * r.detectors[0].detected_errors[0];
  EXPECT_GT(r.detectors[0].detected_of_all_errors[0], of_fraction);
  EXPECT_LT(r.detectors[0].detected_of_all_errors[0], 1.1 * of_fraction);
  EXPECT_TRUE(run_points({through_a_slit(ConeDirection{0.1})}).detectors[0].detected_of_all.empty());
}

TEST(AimedFraction, LeavesNoDetectorWithoutAnErrorWhereNothingArrives) {
  Beamline b = through_a_slit(AimedDirection{"S", CosineEmission{}});
  b.particles = 1000;
  auto& screen = std::get<Detector>(b.parts.back().part);
  screen.offset = {20e-3, 0};
  const Result r = run_points({b});
  EXPECT_EQ(r.detectors[0].detected[0], 0);
  // Wilson's of no count in a thousand that weigh at most 1 each.
  EXPECT_NEAR(r.detectors[0].detected_errors[0] * r.emitted[0], 0.5 / (1 + 1e-3), 1e-4);
}

TEST(AimedFraction, BelongsToARunThatTellsFarMoreOfANarrowSlitForTheSameParticles) {
  // The same particles take the same time: the square of the relative error must be twenty times smaller.
  Beamline whole = through_a_slit(CosineDirection{0.08});
  whole.parts = {place("S", 0.5, Slit{Rectangle{0.1e-3, 5e-3}, {}}),
                 place("screen", 1, Detector{Rectangle{2e-3, 20e-3}, {1, 1}, {}})};
  Beamline aimed = whole;
  aimed.source.direction = AimedDirection{"S", CosineEmission{}};
  auto [all, error] = detected_share(whole);
  all *= std::pow(std::sin(0.08), 2);  // the limit's part of all that leave
  error *= std::pow(std::sin(0.08), 2);
  const auto [share, aimed_error] = detected_share(aimed);
  EXPECT_NEAR(share, all, 4 * std::hypot(error, aimed_error));
  EXPECT_GT(std::pow(error / all, 2), 20 * std::pow(aimed_error / share, 2));
}

TEST(AimedFraction, StandsAtEachPointOfAScanAndNotWhereNothingIsAimed) {
  Beamline near = through_a_slit(AimedDirection{"S", CosineEmission{}}), far = near, whole = near;
  near.particles = far.particles = whole.particles = 1000;
  far.parts[0].placement.at = 0.006;
  whole.source.direction = CosineDirection{};
  const Result r = run_points({near, far, whole});
  ASSERT_EQ(r.aimed_fraction.size(), 3U);
  EXPECT_DOUBLE_EQ(r.aimed_fraction[0], 2e-6 / 16e-6 / pi);
  EXPECT_DOUBLE_EQ(r.aimed_fraction[1], 2e-6 / 36e-6 / pi);
  EXPECT_EQ(r.aimed_fraction[2], 1);
  EXPECT_TRUE(run_points({whole}).aimed_fraction.empty());
}

TEST(Rate, ComesOutAsItWentIn) {
  Beamline b = through_a_slit(CosineDirection{});
  b.particles = 100;
  EXPECT_EQ(run_points({b}).rate, 0);
  b.source.rate = 1e6;
  EXPECT_EQ(run_points({b}).rate, 1e6);
}

// On resonance an effusive beam flips best at w1 l/alpha = 1.2001 pi; there its line is 1.0730 alpha/l wide.
TEST(EffusiveSpeed, FlipsInARotatingFieldAsItsSpeedsAllow) {
  Beamline b = suggested(291.6469e3);
  b.law = QuantumLaw{};
  b.source.speed = EffusiveSpeed{300};
  b.particles = 400000;
  std::get<Detector>(b.parts.back().part) = {Rectangle{4e-3, 4e-3}, {1, 1}, {}};
  const Species& species = b.species[0].species;
  const double alpha = thermal_speed(300, species.mass),
               larmor = std::abs(species.gyromagnetic_ratio) * 10e-3;
  const auto flipped = [&](double detuning, double scale) {
    Beamline point = b;
    auto& h0 = std::get<RotatingField>(point.parts[2].part);
    h0.frequency = (larmor / (2 * pi) + detuning);
    h0.amplitude = scale * 1.2001 * pi * alpha / h0.length / std::abs(species.gyromagnetic_ratio);
    return run_points({point}).detectors[0].levels.at(0);  // the polarizer leaves S = -z
  };
  const double error = std::sqrt(0.25 / 400000);
  const double peak = flipped(0, 1), half_width = 0.5 * 1.0730 * alpha / 0.2;
  EXPECT_NEAR(peak, 0.76576, 4 * error);
  EXPECT_LT(flipped(0, 1.1), peak);
  EXPECT_LT(flipped(0, 0.9), peak);
  EXPECT_NEAR(flipped(half_width, 1), 0.76576 / 2, 4 * error);
  EXPECT_NEAR(flipped(-half_width, 1), 0.76576 / 2, 4 * error);
  EXPECT_GT(std::abs(flipped(1.02 * half_width, 1) - 0.76576 / 2), 4 * error);
}

/// A parallel beam through B and a rotating field in it, to a detector that sees all.
Beamline flipper(const Law& law, const StartSpin& spin, int twice_spin = 1) {
  Beamline b = suggested(291.6469e3, 30e-6);
  b.law = law;
  b.species[0].species.spin = {twice_spin};
  b.source = {SingleSpeed{1000}, Rectangle{1e-4, 1e-4}, ParallelDirection{}};
  b.source.spin = spin;
  b.parts.erase(b.parts.begin());  // no polarizer
  auto& h0 = std::get<RotatingField>(b.parts[1].part);
  h0.phase = {Phase::Kind::angle, 0.7};
  b.particles = 20000;
  return b;
}
/// <S_z>/S at the detector and its error.
std::pair<double, double> spin_along_z(const Result& r) {
  const DetectorResult& d = r.detectors[0];
  const std::size_t n = d.level_labels.size();
  double sum = 0, error = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double s = 1 - 2 * static_cast<double>(k) / static_cast<double>(n - 1);
    sum += s * d.levels[k];
    error += d.levels_errors[k];
  }
  return {sum, error};
}

TEST(StartSpin, AlongZFillsTheLevelsByItsDegree) {
  for (const double sign : {1.0, -1.0}) {
    Beamline b = flipper(QuantumLaw{}, PolarisedSpin{{0, 0, sign}, 0.6});
    b.parts.erase(b.parts.begin(), b.parts.begin() + 2);
    const auto [sz, error] = spin_along_z(run_points({b}));
    EXPECT_NEAR(sz, sign * 0.6, 4 * error);
    EXPECT_GT(std::abs(sz - sign * 0.62), 1.5 * error);
  }
}

TEST(StartSpin, AcrossTheFieldIsInBothLevelsAlike) {
  Beamline b = flipper(QuantumLaw{}, PolarisedSpin{{1, 0, 0}, 1});
  b.parts.erase(b.parts.begin() + 1);
  EXPECT_NEAR(spin_along_z(run_points({b})).first, 0, 1e-9);
}

// <S> obeys the classical equation for every spin, so both laws agree on <S_z>; the way to the rotating field
// turns a spin that starts across z, and counts.
TEST(StartSpin, AlongAnyAxisComesOutAsTheClassicalSpinDoes) {
  for (const UnitVector axis : {UnitVector{0, 0, 1}, UnitVector{0, 0, -1}, UnitVector{1, 0, 0},
                                UnitVector{0.48, 0.64, 0.6}, UnitVector{0, -1, 0}}) {
    for (const int twice_spin : {1, 3}) {
      const StartSpin spin = PolarisedSpin{axis, 1};
      const double quantum = spin_along_z(run_points({flipper(QuantumLaw{}, spin, twice_spin)})).first;
      const double classical = spin_along_z(run_points({flipper(ClassicalLaw{}, spin, twice_spin)})).first;
      EXPECT_NEAR(quantum, classical, 1e-9) << axis.x << ' ' << axis.y << ' ' << axis.z << ' ' << twice_spin;
      EXPECT_GT(std::abs(classical), 0.01);
    }
  }
}

TEST(StartSpin, InLevelsOfAnAxisHasTheAverageOfTheirShares) {
  const StartSpin spin = PopulatedSpin{{0.48, 0.64, 0.6}, {0.6, 0.2, 0.15, 0.05}};
  const auto [full, unused] =
      spin_along_z(run_points({flipper(QuantumLaw{}, PolarisedSpin{{0.48, 0.64, 0.6}, 1}, 3)}));
  const double average = 0.6 + 0.2 / 3 - 0.15 / 3 - 0.05;
  for (const Law& law : {Law{QuantumLaw{}}, Law{ClassicalLaw{}}}) {
    const Result r = run_points({flipper(law, spin, 3)});
    const double error = 1 / std::sqrt(static_cast<double>(r.particles));
    EXPECT_NEAR(spin_along_z(r).first, average * full, 4 * error);
  }
}

TEST(StartSpin, DoesNotOutliveAPolarizer) {
  Beamline b = flipper(QuantumLaw{}, PolarisedSpin{{1, 0, 0}, 1});
  b.parts.insert(b.parts.begin(), place("B_prime", 0.1, Polarizer{0.1, 10e-3, 1, {}}));
  Beamline unpolarised = b;
  unpolarised.source.spin = UnpolarisedSpin{};
  EXPECT_EQ(run_points({b}).detectors[0].levels, run_points({unpolarised}).detectors[0].levels);
}

TEST(StartSpin, AlongTheFieldFliesStraightUnderClosureTorqueAndAcrossItDoesNot) {
  Beamline b = flipper(DoradoLaw{}, PolarisedSpin{{0, 0, 1}, 0.2});
  b.parts.erase(b.parts.begin() + 1);
  EXPECT_EQ(run_points({b}).detectors[0].detected[0], 1);
  b.source.spin = PolarisedSpin{{1, 0, 0}, 1};
  EXPECT_EQ(run_points({b}).detectors[0].detected[0], 0);
}

// A spin across the field that meets a locked rotating field comes out by the phase between both, which a
// pulse of one period averages away, and a short one does not.
TEST(Pulse, MovesTheStartAgainstLockedPhases) {
  Beamline still = flipper(QuantumLaw{}, PolarisedSpin{{0, 1, 0}, 1});
  const double period = 1 / 291.6469e3;
  Beamline shortest = still, whole = still;
  shortest.source.pulse = RectanglePulse{1e-3 * period};
  whole.source.pulse = RectanglePulse{period};
  const double reference = spin_along_z(run_points({still})).first;
  EXPECT_GT(std::abs(reference), 0.2);
  EXPECT_NEAR(spin_along_z(run_points({shortest})).first, reference, 0.01);
  EXPECT_NEAR(spin_along_z(run_points({whole})).first, 0, 4 / std::sqrt(20000.0));
}

}  // namespace
}  // namespace rabiline::source_test
