// Levels in fields that have a period, against Schroedinger's equation, steps, and powers of one period.
#include <gtest/gtest.h>

#include <numeric>
#include <unsupported/Eigen/MatrixFunctions>

#include "spin/level_labels.hpp"
#include "unit/transport/level_laboratory.hpp"

namespace rabiline::level_period_test {
namespace {

/// A uniform field along z [T].
Flight uniform(const CoupledSpins& spins, double speed, double length, double field) {
  Flight f{spins, speed, length, {}};
  CourseSection section;
  section.field.end = length;
  section.field.spin_rate = field;
  section.longest = length / 8;
  section.period = 0;
  f.fields.sections = {section};
  f.fields.begins_in_field = f.fields.ends_in_field = field != 0;
  return f;
}
/// One more that swings, or turns from `first` towards `second`.
void drive(Flight& f, double size, double frequency, double phase, const Eigen::Vector3d& first,
           const Eigen::Vector3d& second = {0, 0, 0}) {
  CourseSection& section = f.fields.sections.back();
  DriveTerm& term = section.field.drive[section.field.drives++];
  term.spin_rate = size;
  term.omega = two_pi * frequency;
  term.phase = phase;
  term.in_xy = false;
  for (int i = 0; i < 3; ++i) {
    term.first[i] = first(i);
    term.second[i] = second(i);
  }
  section.fastest = std::abs(term.omega);
}
Flight in_steps(Flight f) {
  for (CourseSection& section : f.fields.sections) section.period = -1;
  return f;
}
double line_of(const CoupledSpins& spins, double field, int upper, int lower) {
  const std::vector<double> energy = levels_at(spins, field).energy;
  return std::abs(energy[static_cast<std::size_t>(upper)] - energy[static_cast<std::size_t>(lower)]) /
         constants::planck;
}

TEST(LevelPeriod, IsSchroedingersEquationOfWhatSwingsInAnyDirection) {
  const CoupledSpins potassium = of("K-39 atom");
  for (const double sign : {1.0, -1.0}) {
    Flight f = uniform(potassium, 800, 0.004, sign * 0.3e-3);
    drive(f, 40e-6, -sign * 2.1e6, 0.7, {1, 0, 0}, {0, 0.6, 0.3});
    drive(f, 25e-6, -sign * 2.1e6, 2.1, {0.2, -0.5, 1});
    const int level = sign > 0 ? 0 : 4;
    const std::vector<double> p = carried(f, level);
    EXPECT_LT(worst_difference(p, Laboratory(f).carried(level)), 1e-8);
    EXPECT_LT(p[static_cast<std::size_t>(level)], 0.9);
  }
}

TEST(LevelPeriod, IsSchroedingersEquationOfALineBetweenF) {
  const CoupledSpins spins = structure(1, 1, 40e6, 0, 2, 1e-3);
  Flight f = uniform(spins, 800, 0.004, 0.1e-3);
  const std::vector<LevelLabel> labels = level_labels(spins);
  const int upper = *find_weak_field_level(labels, 2, 0), lower = *find_weak_field_level(labels, 0, 0);
  drive(f, 10e-6, line_of(spins, 0.1e-3, upper, lower), 1.1, {0.7, 0, 0.7});
  for (const int level : {upper, lower}) {
    const std::vector<double> p = carried(f, level);
    EXPECT_LT(worst_difference(p, Laboratory(f).carried(level)), 1e-8);
    EXPECT_LT(p[static_cast<std::size_t>(level)], 0.95);
  }
}

TEST(LevelPeriod, IsWhatStepsFindInNoStaticFieldAndInStrongFields) {
  for (const double field : {0.0, 5e-6}) {
    Flight f = uniform(structure(1, 2, 2e6, 0.7e6, 1.3, 1e-4), 800, 0.02, field);
    f.apart = 1e8;
    drive(f, 300e-6, 1.3e6, 0.3, {0.3, 0.8, -0.2});
    for (const int level : {0, 4})
      EXPECT_LT(worst_difference(carried(f, level), carried(in_steps(f), level)), 1e-6);
  }
}

/// Behind a field that turns, levels lie along other axes; and against the field where it has been reversed.
TEST(LevelPeriod, GoesOnFromAFieldThatHasTurnedAsStepsDo) {
  for (const double sign : {1.0, -1.0}) {
    Flight f = flight(of("K-39 atom"), 800, 0.02, linear(20e-6, 2e-6, 0, 0, 0.003, sign * 0.02), 0.011);
    f.apart = 1e9;
    f.length = 0.04;
    CourseSection second = f.fields.sections[0];
    second.shaped_begin = second.shaped_end;
    second.field.begin = 0.02;
    second.field.end = 0.04;
    second.field.spin_rate = 0.2e-3;
    second.field.turned = true;
    const double frame[9] = {0.6, 0, -0.8, 0, 1, 0, 0.8, 0, 0.6};
    std::ranges::copy(frame, second.field.frame);
    second.period = 0;
    f.fields.sections.push_back(second);
    drive(f, 30e-6, 1.4e6, 0.3, {1, 0.2, 0}, {0, 0.7, 0});
    for (const int level : {sign > 0 ? 0 : 5}) {
      const std::vector<double> p = carried(f, level);
      EXPECT_LT(worst_difference(p, carried(in_steps(f), level)), 1e-6);
      EXPECT_LT(p[static_cast<std::size_t>(level)], 0.95);
    }
  }
}

/// Two of them with a gap, of one clock: what turns in between is followed.
TEST(LevelPeriod, KeepsThePhaseBetweenTwoFields) {
  const CoupledSpins spins = structure(1, 1, 40e6, 0, 2, 1e-3);
  const std::vector<LevelLabel> labels = level_labels(spins);
  const int upper = *find_weak_field_level(labels, 2, 0), lower = *find_weak_field_level(labels, 0, 0);
  Flight f = uniform(spins, 800, 0.002, 0.1e-3);
  f.apart = 1e9;
  CourseSection gap = f.fields.sections[0];
  gap.period = -1;
  gap.field.begin = 0.002;
  gap.field.end = 0.006;
  CourseSection last = f.fields.sections[0];
  last.period = 1;
  last.field.begin = 0.006;
  last.field.end = f.length = 0.008;
  const double frequency = line_of(spins, 0.1e-3, upper, lower) + 40e3;
  drive(f, 20e-6, frequency, 1.1, {0.3, 0, 0.7});
  f.fields.sections.push_back(gap);
  f.fields.sections.push_back(last);
  drive(f, 20e-6, frequency, 1.9, {0.3, 0, 0.7});
  const std::vector<double> p = carried(f, upper);
  EXPECT_LT(worst_difference(p, carried(in_steps(f), upper)), 1e-6);
  EXPECT_GT(p[static_cast<std::size_t>(lower)], 0.1);
  f.fields.sections[2].field.drive[0].phase += 0.01;
  EXPECT_GT(worst_difference(p, carried(f, upper)), 1e-4);
}

/// A caesium clock's line over 459,632 periods, by one period that is squared again and again.
TEST(LevelPeriod, IsAPowerOfOnePeriod) {
  const CoupledSpins spins = of("Cs-133 atom");
  constexpr double field = 6e-6;
  constexpr int periods = 459632;
  const std::vector<LevelLabel> labels = level_labels(spins);
  const int upper = *find_weak_field_level(labels, 8, 0), lower = *find_weak_field_level(labels, 6, 0);
  const double frequency = line_of(spins, field, upper, lower) + 5e3, stay = periods / frequency;
  Flight f = uniform(spins, 200, 200 * stay, field);
  drive(f, 1e-6, frequency, 0, {0, 0, 1});
  const Eigen::MatrixXcd moment = two_pi * (spins.zeeman_j * in_product_basis(spins, true, 2) +
                                            spins.zeeman_i * in_product_basis(spins, false, 2));
  const Levels levels = levels_at(spins, field);
  const Eigen::MatrixXcd states = levels.states.cast<Complex>(), seen = states.adjoint() * moment * states;
  Eigen::MatrixXcd still = Eigen::MatrixXcd::Zero(spins.levels(), spins.levels());
  const double mean = std::accumulate(levels.energy.begin(), levels.energy.end(), 0.0) / spins.levels();
  for (int k = 0; k < spins.levels(); ++k)
    still(k, k) = (levels.energy[static_cast<std::size_t>(k)] - mean) / constants::hbar;
  Eigen::MatrixXcd whole = Eigen::MatrixXcd::Identity(spins.levels(), spins.levels());
  constexpr int steps = 256;
  const double time = 1 / frequency / steps;
  for (int i = 0; i < steps; ++i) {
    // Magnus' series to the fourth order at Gauss' points.
    const auto at = [&](double share) -> Eigen::MatrixXcd {
      return still + 1e-6 * std::cos(two_pi * (i + share) / steps) * seen;
    };
    const double gauss = std::sqrt(3.0) / 6;
    const Eigen::MatrixXcd a = at(0.5 - gauss), b = at(0.5 + gauss);
    const Eigen::MatrixXcd omega =
        Complex(0, -time / 2) * (a + b) + std::sqrt(3.0) / 12 * time * time * Complex(1, 0) * (a * b - b * a);
    whole = (omega.exp() * whole).eval();
  }
  Eigen::MatrixXcd power = Eigen::MatrixXcd::Identity(spins.levels(), spins.levels());
  for (int n = periods; n > 0; n /= 2) {
    if (n % 2 == 1) power = (whole * power).eval();
    whole = (whole * whole).eval();
  }
  const std::vector<double> p = carried(f, upper);
  for (int k = 0; k < spins.levels(); ++k)
    EXPECT_NEAR(p[static_cast<std::size_t>(k)], std::norm(power(k, upper)), 2e-7) << k;
  EXPECT_GT(p[static_cast<std::size_t>(lower)], 0.05);
}

TEST(LevelPeriod, GivesTheSameBitsOnEachInstructionSet) {
  Flight f = uniform(of("K-39 atom"), 800, 0.02, 0.3e-3);
  drive(f, 40e-6, 2.1e6, 0.7, {1, 0, 0}, {0, 0.6, 0.3});
  const std::vector<double> p = all_carried(f, 0, Isa::baseline);
  for (const Isa isa : {Isa::avx2, Isa::avx512})
    if (supported(isa)) {
      EXPECT_EQ(p, all_carried(f, 0, isa));
    }
}

}  // namespace
}  // namespace rabiline::level_period_test
