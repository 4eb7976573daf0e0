// Levels of atoms driven in the rotating-wave approximation on a way through any field, against
// Schroedinger's equation of both spins under the whole fields, and against the closed form where the field
// is uniform.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "spin/driven_levels.hpp"
#include "unit/transport/level_laboratory.hpp"

namespace rabiline::level_wave_test {
namespace {

/// A field [T] that swings along an axis all along the way as half a sine, in the rotating-wave
/// approximation.
void drive(Flight& f, double field, double frequency, const Eigen::Vector3d& axis) {
  DriveTerm term;
  term.spin_rate = field;
  term.omega = two_pi * frequency;
  term.phase = 0.7;
  term.in_xy = false;
  for (int k = 0; k < 3; ++k) {
    term.first[k] = axis(k);
    term.second[k] = 0;
  }
  term.envelope = {Shape::half_sine, 0, f.length};
  WaveFields wave;
  wave.frequency = frequency;
  wave.drives = {term};
  std::vector<WavePlace> places;
  for (int i = 0; i < 129; ++i) {
    FieldHere<double> here{};
    add_field<HostMaths>(f.fields.shaped[0], 0.0, (i + 0.5) / 129 * f.length, 0.0, here);
    const Eigen::Vector3d b(here.field[0], here.field[1], here.field[2]);
    const double along = std::abs(axis.dot(b)) / b.norm(),
                 across = std::sqrt(std::max(0.0, 1 - along * along));
    const double turning = f.speed * std::hypot(here.slope[1], here.slope[4], here.slope[7]) / b.norm();
    places.push_back({b.norm(), turning, field * across, field * across, field * along});
  }
  wave.frame =
      wave_frame(f.spins, manifolds_of(f.spins, f.apart), std::vector<WaveAlong>{{frequency, places}}, 1e-3);
  f.fields.sections[0].wave = static_cast<int>(f.fields.waves.size());
  f.fields.waves.push_back(wave);
}

/// F = 2 and 1 of I = 3/2 and J = 1/2, 40 MHz apart, in a weak field that turns quickly.
Flight between_manifolds() {
  Flight f =
      flight(structure(3, 1, 20e6, 0, 2.002, 2e-4), 1000, 0.1, linear(0.2e-6, 0, 2e-6, 0, 0, 40e-6), 0.03);
  drive(f, 2e-6, 40.01e6, Eigen::Vector3d(0.6, 0, 0.8));
  return f;
}
/// Through the resonance of F = 2 with 3 MHz.
Flight within_a_manifold(double across = 0.01e-3) {
  Flight f = flight(of("K-39 atom"), 800, 0.06, linear(across, 0, 0.4286e-3, 0, 0, 0.002), 0.03);
  drive(f, 8e-6, 3e6, Eigen::Vector3d(1, 0, 0));
  return f;
}

TEST(LevelWave, IsSchroedingersEquationOfALineBetweenManifoldsWhileTheFieldTurns) {
  const Flight f = between_manifolds();
  for (const int level : {1, 6}) {
    const std::vector<double> p = carried(f, level);
    EXPECT_LT(worst_difference(p, Laboratory(f).carried(level)), 1e-4) << level;  // the rest mixes m by 2e-4
    EXPECT_LT(p[static_cast<std::size_t>(level)], 0.9) << level;
  }
  Flight other = f;
  other.fields.waves[0].drives[0].spin_rate *= 1.01;
  EXPECT_GT(worst_difference(carried(f, 1), carried(other, 1)), 1e-3);
}

TEST(LevelWave, IsSchroedingersEquationOfLinesOfOneManifold) {
  const Flight f = within_a_manifold();
  for (const int level : {0, 2}) {
    const std::vector<double> p = carried(f, level);
    EXPECT_LT(worst_difference(p, Laboratory(f).carried(level)), 5e-4) << level;
    EXPECT_LT(p[static_cast<std::size_t>(level)], 0.9) << level;
  }
}

/// Half of a line of F = 2 and 1, 40 MHz apart, under a field that is not along the axis.
TEST(LevelWave, IsSchroedingersEquationOfALineOfTwoPhotons) {
  Flight f = flight(structure(3, 1, 20e6, 0, 2.002, 2e-4), 1000, 0.3, linear(20e-6, 0, 80e-6, 0, 0, 0), 0);
  const int from = 6, to = 2;
  const double line = transition_frequency(levels_at(f.spins, std::hypot(20e-6, 80e-6)), from, to);
  drive(f, 70e-6, line / 2 + 12.5e3, Eigen::Vector3d(0.6, 0, 0.8));
  const std::vector<double> p = carried(f, from);
  EXPECT_LT(worst_difference(p, Laboratory(f).carried(from)), 3e-2);  // third order
  EXPECT_LT(p[static_cast<std::size_t>(from)], 0.8);
  Flight without = f;
  without.fields.waves[0].frame.two.clear();
  EXPECT_GT(carried(without, from)[static_cast<std::size_t>(from)], 0.9);
}

TEST(LevelWave, NamesLevelsAnewWhereTheFieldHasBeenReversed) {
  // Past a zero of the field in front of the drive: those names are of the field against the axis.
  const Flight straight = within_a_manifold(0);
  Flight f = straight;
  f.fields.shaped[0].linear.field[2] *= -1;
  f.fields.shaped[0].linear.slope[7] *= -1;
  CourseSection before;
  before.field.begin = -0.02;
  before.longest = 0.002;
  before.shaped_begin = 1;
  before.shaped_end = 2;
  f.fields.shaped.push_back(ShapedTerm(linear(0, 0, -0.4e-3, 0, 0, -0.08)));
  f.fields.sections.insert(f.fields.sections.begin(), before);
  // m of the one field is -m of the other: F=2 m=-2 becomes m=2.
  EXPECT_LT(worst_difference(carried(f, 4), carried(straight, 0)), 1e-6);
}

TEST(LevelWave, IsTheClosedFormInAUniformField) {
  const CoupledSpins caesium = of("Cs-133 atom");
  Flight f = flight(caesium, 250, 0.02, linear(0, 0, 6e-6, 0, 0, 0), 0);
  drive(f, 0.9e-6, 9192631800, Eigen::Vector3d(0.28, 0, 0.96));
  RotatingTerm term;
  term.amplitude = 0.9e-6;
  term.motion = FieldMotion::swings_in_rotating_wave;
  term.first = {0.28, 0, 0.96};
  term.oscillator.frequency = 9192631800;
  term.oscillator.phase = 0.7;
  term.envelope = {Shape::half_sine, 0, 0.02};
  const DrivenLevels closed(caesium, {{0, 0.02, 6e-6, term}}, 1.0 / 200);
  SpinPath path;
  path.levels = caesium.levels();
  path.of_atom = true;
  path.transitions = &closed;
  for (const int level : {3, 4, 12}) {
    const std::vector<double> p = carried(f, level);
    EXPECT_LT(worst_difference(p, of_first(all_carried_along(path, f, level, best_isa()))), 1e-6) << level;
    if (level != 3) {
      EXPECT_LT(p[static_cast<std::size_t>(level)], 0.99) << level;
    }
  }
}

/// Two pulses on caesium's clock line are Ramsey's method in time: 5 us each, 40 us from begin to begin.
TEST(LevelWave, OfTwoPulsesHasRamseysFringes) {
  const CoupledSpins caesium = of("Cs-133 atom");
  const double tau = 5e-6, period = 40e-6, line = transition_frequency(levels_at(caesium, 6e-6), 12, 4);
  for (const double detuning : {0.0, 7e3, -19e3}) {
    Flight f = flight(caesium, 250, 0.02, linear(0, 0, 6e-6, 0, 0, 0), 0);
    const double moment = std::abs(caesium.zeeman_j - caesium.zeeman_i) / 2;  // [Hz/T] of m=0 along z
    drive(f, 1 / (4 * tau) / moment, line + detuning, Eigen::Vector3d(0, 0, 1));
    DriveTerm& term = f.fields.waves[0].drives[0];
    term.envelope = {};
    term.gate = {10e-6, 10e-6 + tau, period, 2};
    f.fields.sections[0].is_pulsed = true;
    const double w1 = two_pi * moment * term.spin_rate, delta = two_pi * detuning, a = std::hypot(w1, delta);
    const double s = w1 / a, c = delta / a, half = a * tau / 2, free = delta * (period - tau) / 2;
    const double flips = 4 * s * s * std::pow(std::sin(half), 2) *
                         std::pow(std::cos(free) * std::cos(half) - c * std::sin(free) * std::sin(half), 2);
    const std::vector<double> p = carried(f, 4);
    EXPECT_NEAR(p[12], flips, 2e-5) << detuning;
    EXPECT_NEAR(p[4], 1 - flips, 2e-5) << detuning;
  }
}

TEST(LevelWave, GivesTheSameBitsOnEachInstructionSet) {
  const Flight f = between_manifolds();
  const std::vector<double> p = all_carried(f, 1, Isa::baseline);
  for (const Isa isa : {Isa::avx2, Isa::avx512}) {
    if (supported(isa)) {
      EXPECT_EQ(all_carried(f, 1, isa), p);
    }
  }
}

}  // namespace
}  // namespace rabiline::level_wave_test
