// Blocks and closed forms against the whole state, zone by zone, at random slownesses.
#include "spin/evolution.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>

#include "core/constants.hpp"
#include "core/eigensystem.hpp"
#include "drives.hpp"
#include "spin/atoms.hpp"
#include "spin/driven_levels.hpp"
#include "spin/rotating_frame.hpp"
#include "unit/transport/readers.hpp"

namespace rabiline::evolution_test {
namespace {

using Cycles = long double;  // 1e8 cycles of a clock, to 1e-10 of a cycle

std::complex<double> phase_of(Cycles cycles) {
  const double angle = static_cast<double>(2 * 3.14159265358979323846264L * (cycles - std::round(cycles)));
  return {std::cos(angle), -std::sin(angle)};
}
Eigen::MatrixXcd turning(const Eigen::Vector<Cycles, Eigen::Dynamic>& cycles) {
  return cycles.unaryExpr(&phase_of).asDiagonal();
}

/// P(from -> to) of all levels at once: in the laboratory between zones, in a zone in its drive's own frame.
/// A profile is cut into equal parts of constant amplitude, each that in its middle.
Eigen::MatrixXd of_the_whole_state(const CoupledSpins& spins, const std::vector<LevelZone>& zones, double s,
                                   int parts = 1) {
  const std::vector<LevelLabel> labels = level_labels(spins);
  Eigen::MatrixXcd u = Eigen::MatrixXcd::Identity(spins.levels(), spins.levels());
  double last = zones.front().begin;
  for (const LevelZone& zone : zones) {
    const auto free = [&](double field, double length) {
      const Levels levels = levels_at(spins, field);
      Eigen::Vector<Cycles, Eigen::Dynamic> cycles(spins.levels());
      for (int i = 0; i < spins.levels(); ++i)
        cycles(i) = static_cast<Cycles>(levels.energy[i] / constants::planck) * length * s;
      return turning(cycles);
    };
    u = (free(0, zone.begin - last) * u).eval();
    last = zone.end;
    if (!zone.drive) {
      u = (free(zone.field, zone.end - zone.begin) * u).eval();
      continue;
    }
    const DrivenStates states = driven_states(spins, levels_at(spins, zone.field), *zone.drive);
    const DrivenStates* const alone[] = {&states};
    const RotatingFrame frame =
        rotating_frame(labels, sense_of(*zone.drive), zone.drive->oscillator.frequency, alone);
    const StandingCoupling standing = standing_coupling(frame, states);
    const auto into_frame = [&](double y) {
      Eigen::Vector<Cycles, Eigen::Dynamic> cycles(spins.levels());
      for (int i = 0; i < spins.levels(); ++i)
        cycles(i) = -frame.photons[i] * (static_cast<Cycles>(frame.frequency) * y * s +
                                         zone.drive->oscillator.phase / constants::two_pi) -
                    labels[i].twice_m / 2.0 * states.axis / constants::two_pi;
      return turning(cycles);
    };
    u = (into_frame(zone.begin) * u).eval();
    const double step = (zone.end - zone.begin) / parts;
    for (int k = 0; k < parts; ++k) {
      Eigen::MatrixXd h = standing.at(share_of(zone.drive->envelope, zone.begin + (k + 0.5) * step));
      for (int i = 0; i < spins.levels(); ++i)
        h(i, i) += states.energy(i) - frame.photons[i] * frame.frequency;
      const auto own = eigensystem_of(h);
      const Eigen::Vector<Cycles, Eigen::Dynamic> cycles = own.values.cast<Cycles>() * (step * s);
      u = (own.vectors * turning(cycles) * own.vectors.transpose() * u).eval();
    }
    u = (into_frame(zone.end).adjoint() * u).eval();
  }
  return u.cwiseAbs2().transpose();
}

double worst_at_random(const CoupledSpins& spins, const std::vector<LevelZone>& zones, double from, double to,
                       int parts = 1) {
  const DrivenLevels driven(spins, zones, to);
  std::mt19937_64 random(11);
  double worst = 0;
  for (int k = 0; k < 20; ++k) {
    const double s = std::uniform_real_distribution(from, to)(random);
    const Eigen::MatrixXd whole = of_the_whole_state(spins, zones, s, parts);
    for (const Isa isa : test::instruction_sets())
      worst = std::max(worst, difference(test::probabilities(driven, s, isa), whole));
  }
  return worst;
}

/// Two zones of the clock's line, 1 m apart.
std::vector<LevelZone> clock_zones(double off = 0, double amplitude = 4.6e-7, double field = 6e-6) {
  const RotatingTerm first = along_z(drive(oscillating, amplitude, 9192631771.539 + off, 0.2));
  RotatingTerm second = first;
  second.oscillator.phase = 0.9;
  return {{0.4, 0.41, field, first}, {0.41, 1.4, field, std::nullopt}, {1.4, 1.41, field, second}};
}

TEST(Evolution, OfAClockWithZonesOneMetreApartIsThatOfTheWholeStateAtEverySpeed) {
  const CoupledSpins spins = coupled_spins(*find_atom("Cs-133"));
  for (const double off : {0.0, 37.0, -500.0})
    EXPECT_LT(worst_at_random(spins, clock_zones(off), 1.0 / 900, 1.0 / 25), 1e-8);
  EXPECT_LT(DrivenLevels(spins, clock_zones(), 0.04).blocks().size(), 8U);
  const Eigen::MatrixXd p = test::probabilities(DrivenLevels(spins, clock_zones(), 0.04), 4e-3);
  EXPECT_GT(difference(p, of_the_whole_state(spins, clock_zones(0, 1.01 * 4.6e-7), 4e-3)), 1e-3);
  EXPECT_GT(difference(p, of_the_whole_state(spins, clock_zones(0, 4.6e-7, 1.01 * 6e-6), 4e-3)), 1e-3);
}

TEST(Evolution, OfAllLevelsOfPotassiumIsThatOfTheWholeState) {
  const CoupledSpins spins = coupled_spins(*find_atom("K-39"));
  for (const double f : {461.37e6, 461.72e6, 0.35e6}) {
    RotatingTerm first = drive(oscillating, 1.6e-6, f, 0.4);
    first.first = {0.6, 0, 0.8};
    const std::vector<LevelZone> zones{
        {0.5, 0.52, 5e-5, first}, {0.52, 1.5, 4e-5, std::nullopt}, {1.5, 1.53, 5e-5, first}};
    EXPECT_LT(worst_at_random(spins, zones, 1e-3, 1e-2), 1e-8) << f;
  }
}

TEST(Evolution, OverAGapWithoutAFieldIsThatOfTheWholeState) {
  const CoupledSpins spins = coupled_spins(*find_atom("Na-23"));
  const RotatingTerm turns = drive(positive, 2.5e-7, 140e3, 0.3);
  EXPECT_LT(worst_at_random(spins, {{0, 0.1, 2e-5, turns}, {1.1, 1.2, 2.1e-5, turns}}, 1e-3, 4e-3), 1e-8);
}

TEST(Evolution, OnSeveralClocksWithRandomPhasesIsTheMeanOfWholeStates) {
  const CoupledSpins spins = small_atom(1, 1);
  const double f = transition_frequency(levels_at(spins, 2e-6), 3, 1), s = 3.3e-3;
  const auto zones = [&](bool random, double phase) -> std::vector<LevelZone> {
    const RotatingTerm first = on_clock(along_z(drive(oscillating, 5e-7, f, 0.2)), 0, random);
    RotatingTerm second = on_clock(drive(oscillating, 5e-7, f + 3e3, phase), 4, random);
    second.first = {0.6, 0, 0.8};
    return {{0, 0.02, 2e-6, first},
            {0.02, 1, 2e-6, std::nullopt},
            {1, 1.03, 2e-6, second},
            {1.1, 1.12, 2e-6, first}};
  };
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(4, 4);
  for (int k = 0; k < 16; ++k)
    mean += of_the_whole_state(spins, zones(false, constants::two_pi * k / 16), s) / 16;
  const Eigen::MatrixXd p = test::probabilities(DrivenLevels(spins, zones(true, 0), 0.02), s);
  EXPECT_LT(difference(p, mean), 1e-8);
  EXPECT_GT(difference(p, of_the_whole_state(spins, zones(false, 0), s)), 1e-3);
}

TEST(Evolution, UnderProfilesIsThatOfTheWholeStateInManyParts) {
  const CoupledSpins spins = coupled_spins(*find_atom("H"));
  for (const Shape shape : {Shape::half_sine, Shape::gaussian}) {
    RotatingTerm field = drive(oscillating, 2.6e-6, 1.4e6, 0.2);
    field.envelope = {shape, 0.1, 0.05, 0.008};
    RotatingTerm again = field;
    again.envelope.begin = 1.1;
    const std::vector<LevelZone> zones{
        {0.1, 0.15, 1e-4, field}, {0.15, 1.1, 1e-4, std::nullopt}, {1.1, 1.15, 1e-4, again}};
    // Parts of constant amplitude are right to the square of their length: Richardson's rule.
    const double s = 6e-4;
    const Eigen::MatrixXd coarse = of_the_whole_state(spins, zones, s, 500);
    const Eigen::MatrixXd fine = of_the_whole_state(spins, zones, s, 1000);
    for (const double largest : {s, 2 * s})
      EXPECT_LT(
          difference(test::probabilities(DrivenLevels(spins, zones, largest), s), fine + (fine - coarse) / 3),
          2e-8);
    EXPECT_GT(1 - fine(0, 0), 0.1);
  }
}

TEST(Evolution, OfLevelsThatNothingMixesIsNone) {
  const CoupledSpins spins = coupled_spins(*find_atom("Cs-133"));
  const DrivenLevels driven(spins, clock_zones(), 0.04);
  // F=4 m=+4 and m=-4 have no partner in F=3.
  EXPECT_EQ(driven.block_of()[0], -1);
  EXPECT_EQ(driven.block_of()[8], -1);
  EXPECT_EQ(driven.reachable_from(0), 1U);
  EXPECT_EQ(driven.reachable_from(4), 1U << 4 | 1U << 12);
  EXPECT_EQ(driven.blocks().size(), 7U);
  EXPECT_EQ(test::probabilities(driven, 3e-3)(0, 0), 1);
  EXPECT_TRUE(DrivenLevels(spins, clock_zones(0, 0), 0.04).blocks().empty());
}

}  // namespace
}  // namespace rabiline::evolution_test
