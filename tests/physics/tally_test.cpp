// What a spin is found in, read from tallies, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "constants.hpp"
#include "physics/suggested.hpp"

namespace rabiline::tally_test {
namespace {

using test::pi;
using test::place;
using test::run_points;
using test::two_pi;

constexpr double speed = 1000, length = 0.2, field = 10e-3;

/// One uniform and one rotating field around it, no polarizer where `aligned` is false; a monitor behind.
Beamline flipper(double detuning, double amplitude, bool aligned, std::vector<Tally> tallies) {
  Beamline b = test::suggested(0);
  b.law = QuantumLaw{};
  b.source.speed = SingleSpeed{speed};
  b.parts[1] = place("B", 0.3, UniformField{length, field, {}});
  RotatingField drive = std::get<RotatingField>(b.parts[2].part);
  drive.length = length;
  drive.amplitude = amplitude;
  drive.phase = {Phase::Kind::locked, 0};
  drive.frequency = std::abs(test::neutron().gyromagnetic_ratio) * field / two_pi + detuning;
  b.parts[2] = place("H0", 0.3, drive);
  Monitor monitor{Disc{0.01}, {}};
  monitor.tallies = std::move(tallies);
  b.parts.insert(b.parts.end() - 1, place("M", 0.7, monitor));
  if (!aligned) b.parts.erase(b.parts.begin());
  b.particles = 4000;
  return b;
}
/// H0 that turns a neutron's spin by this angle on resonance.
double amplitude_for(double angle) {
  return angle * speed / (length * std::abs(test::neutron().gyromagnetic_ratio));
}
double rabi(double detuning, double amplitude, double gamma_error = 1) {
  const double w1 = std::abs(test::neutron().gyromagnetic_ratio) * amplitude * gamma_error,
               rate = std::hypot(w1, two_pi * detuning);
  return std::pow(w1 / rate * std::sin(rate * length / speed / 2), 2);
}
Tally spin_along(UnitVector along) { return {"s", {{Quantity::spin, AxisEnd{-1}, AxisEnd{1}, 2, along}}}; }

TEST(SpinTally, FlipsAsRabisFormulaSays) {
  for (const double detuning : {0.0, 1e3, 2.5e3, 6e3}) {
    const double amplitude = amplitude_for(2.0);
    // A neutron's moment along the field is S = -z, so flipped ones are found at +1.
    const auto counts = run_points({flipper(detuning, amplitude, true, {spin_along({})})}).tallies[0].counts;
    EXPECT_NEAR(counts[1] / 4000, rabi(detuning, amplitude), 1e-8) << detuning;
    EXPECT_GT(std::abs(counts[1] / 4000 - rabi(detuning, amplitude, 1.01)), 1e-6) << detuning;
  }
}

TEST(SpinTally, FindsATransverseSpinWholeAcrossTheFieldAfterAQuarterTurn) {
  const auto expected = [](UnitVector along) {
    const auto b = flipper(0, amplitude_for(pi / 2), true, {spin_along(along)});
    const auto counts = run_points({b}).tallies[0].counts;
    return (counts[1] - counts[0]) / 4000;
  };
  const double x = expected({1, 0, 0}), y = expected({0, 1, 0});
  EXPECT_NEAR(x * x + y * y, 1, 1e-8);
  EXPECT_NEAR(expected({0, 0, 1}), 0, 1e-8);
  EXPECT_NEAR(expected({-1, 0, 0}), -x, 1e-12);
  EXPECT_NEAR(expected({std::sqrt(0.5), std::sqrt(0.5), 0}), (x + y) * std::sqrt(0.5), 1e-8);
}

TEST(SpinTally, IsTheProjectionItselfUnderAVectorLaw) {
  Beamline b = flipper(0, amplitude_for(pi / 3), true,
                       {{"s", {{Quantity::spin, AxisEnd{-1}, AxisEnd{1}, 200, UnitVector{}}}}});
  b.law = ClassicalLaw{};
  const TallyResult t = run_points({b}).tallies[0];
  EXPECT_NEAR(t.axes[0].mean[0], -std::cos(pi / 3), 1e-6);
  EXPECT_NEAR(t.axes[0].deviation[0], 0, 1e-6);
}

/// |d^I_{m'm}(beta)|^2 by Wigner's sum, p = sin^2(beta/2), all arguments twice their value.
double majorana(int twice_i, int twice_m, int twice_to, double p) {
  const auto factorial = [](int n) { return std::tgamma(n + 1.0); };
  const int plus = (twice_i + twice_m) / 2, minus = (twice_i - twice_m) / 2,
            to_plus = (twice_i + twice_to) / 2, to_minus = (twice_i - twice_to) / 2;
  double d = 0;
  for (int k = 0; k <= twice_i; ++k) {
    if (plus - k < 0 || to_minus - k < 0 || to_plus - plus + k < 0) continue;
    const double sign = (to_plus - plus + k) % 2 == 0 ? 1 : -1;
    d += sign * std::pow(std::sqrt(1 - p), twice_i + plus - to_plus - 2 * k) *
         std::pow(std::sqrt(p), to_plus - plus + 2 * k) /
         (factorial(plus - k) * factorial(k) * factorial(to_plus - plus + k) * factorial(to_minus - k));
  }
  return d * d * factorial(plus) * factorial(minus) * factorial(to_plus) * factorial(to_minus);
}

TEST(StateToStateMatrix, OfSpinThreeHalvesIsMajoranas) {
  EXPECT_NEAR(majorana(3, 3, 3, 0.25), 0.421875, 1e-12);
  EXPECT_NEAR(majorana(3, 3, -3, 0.25), 0.015625, 1e-12);
  const TallyAxis prepared{Quantity::prepared_level, {}, {}, {}, {}}, level{Quantity::level, {}, {}, {}, {}};
  Beamline b = flipper(0, amplitude_for(2 * std::asin(0.5)), false, {{"states", {prepared, level}}});
  b.species[0].species.spin = {3};
  const TallyResult t = run_points({b}).tallies[0];
  ASSERT_EQ(t.counts.size(), 16U);
  EXPECT_EQ(t.axes[0].labels.front(), "m = +3/2");
  bool told_apart = false;
  for (int from = 0; from < 4; ++from) {
    double row = 0;
    for (int to = 0; to < 4; ++to) row += t.counts[static_cast<std::size_t>(4 * from + to)];
    EXPECT_NEAR(row, 1000, 4 * std::sqrt(4000 * 0.25 * 0.75));
    for (int to = 0; to < 4; ++to) {
      const double share = t.counts[static_cast<std::size_t>(4 * from + to)] / row;
      EXPECT_NEAR(share, majorana(3, 3 - 2 * from, 3 - 2 * to, 0.25), 1e-8) << from << " to " << to;
      told_apart = told_apart || std::abs(share - majorana(3, 3 - 2 * from, 3 - 2 * to, 0.2525)) > 1e-4;
    }
  }
  EXPECT_TRUE(told_apart);
}

TEST(StateToStateMatrix, HasItsLevelsInTheOrderOfTheDetectors) {
  const TallyAxis level{Quantity::level, {}, {}, {}, {}};
  Beamline b = flipper(0, amplitude_for(1), true, {});
  b.species[0].species.spin = {3};
  for (PlacedPart& part : b.parts)
    if (auto* screen = std::get_if<Detector>(&part.part)) screen->tallies = {{"states", {level}}};
  const Result r = run_points({b});
  ASSERT_EQ(r.tallies.size(), 1U);
  EXPECT_EQ(r.tallies[0].axes[0].labels, r.detectors[0].level_labels);
  double all = 0;
  for (const double count : r.tallies[0].counts) all += count;
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(r.tallies[0].counts[i] / all, r.detectors[0].levels[i], 1e-8) << i;
  EXPECT_GT(std::abs(r.detectors[0].levels[0] - r.detectors[0].levels[3]), 0.1);
}

TEST(StateToStateMatrix, RemembersThePolarizerAndNotTheSource) {
  const TallyAxis prepared{Quantity::prepared_level, {}, {}, {}, {}};
  Beamline b = flipper(0, amplitude_for(1), true, {{"prepared", {prepared}}});
  b.species[0].species.spin = {3};
  std::get<Polarizer>(b.parts[0].part).alignment = 0.5;
  Monitor before{Disc{0.01}, {}};
  before.tallies = {{"prepared", {prepared}}};
  b.parts.insert(b.parts.begin(), place("M0", 0.10, before));  // where the polarizer begins, and before it
  const Result r = run_points({b});
  for (const double count : r.tallies[0].counts) EXPECT_NEAR(count, 1000, 4 * std::sqrt(750.0));
  EXPECT_EQ(r.tallies[1].counts[1] + r.tallies[1].counts[2], 0);
  EXPECT_NEAR(r.tallies[1].counts[3], 3000, 4 * std::sqrt(750.0));  // a neutron's moment along B is m = -3/2
}

}  // namespace
}  // namespace rabiline::tally_test
