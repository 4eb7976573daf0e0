#include "spin/driven_levels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/constants.hpp"
#include "drives.hpp"
#include "laboratory.hpp"
#include "spin/atoms.hpp"
#include "spin/majorana.hpp"
#include "unit/transport/readers.hpp"

namespace rabiline::driven_levels_test {
namespace {

/// N. Ramsey's formula for two fields of the time tau each, a time T apart.
double ramsey(double w1, double detuning, double tau, double between) {
  const double a = std::hypot(w1, detuning), sine = w1 / a, cosine = detuning / a;
  return 4 * std::pow(sine * std::sin(a * tau / 2) *
                          (std::cos(detuning * between / 2) * std::cos(a * tau / 2) -
                           cosine * std::sin(detuning * between / 2) * std::sin(a * tau / 2)),
                      2);
}

TEST(DrivenLevels, OfASpinOneHalfFollowRabisFormulaInTheSenseThatItsPrecessionHas) {
  const double larmor = 2.8e10 * 1e-3;
  for (const double s : {1e-3, 2e-3, 5e-3})
    for (const double off : {0.0, 1500.0, -4000.0}) {
      const LevelZone right{0, 0.1, 1e-3, drive(positive, 1e-7, larmor + off)};
      const LevelZone wrong{0, 0.1, 1e-3, drive(negative, 1e-7, larmor + off)};
      const double w1 = two_pi * 2800;
      const auto flip = [&](const LevelZone& zone, int from, int to) {
        return test::probabilities(DrivenLevels(half(), {zone}, slowest), s)(from, to);
      };
      EXPECT_NEAR(flip(right, 0, 1), rabi(w1, two_pi * off, 0.1 * s), 1e-9);
      EXPECT_NEAR(flip(right, 1, 0), rabi(w1, two_pi * off, 0.1 * s), 1e-9);
      EXPECT_LT(flip(wrong, 0, 1), 1.1 * std::pow(w1 / (2 * two_pi * larmor), 2));
    }
  EXPECT_EQ(DrivenLevels(half(), {{0, 0.1, 1e-3, drive(positive, 1e-7, larmor)}}, slowest).neglected(), 0);
}

TEST(DrivenLevels, OfAFreeSpinFollowMajoranasFormula) {
  const CoupledSpins spins{.twice_i = 3, .zeeman_i = -1e7};
  for (const double off : {0.0, 700.0}) {
    const DrivenLevels driven(spins, {{0, 0.2, 0.1, drive(negative, 1e-4, 1e6 + off)}}, slowest);
    const double s = 1.7e-3, p = rabi(two_pi * 1e3, two_pi * off, 0.2 * s);
    const Eigen::MatrixXd expected = test::probabilities(majorana_table(3), p);
    for (int from = 0; from < 4; ++from)
      for (int to = 0; to < 4; ++to)
        EXPECT_NEAR(test::probabilities(driven, s)(from, to), expected(from, to), 1e-9);
  }
}

TEST(DrivenLevels, OfHydrogenFlopBetweenAllThreeOfTheTriplet) {
  const CoupledSpins spins = coupled_spins(*find_atom("H"));
  const double field = 2e-6, h1 = 4e-8, per_tesla = (spins.zeeman_j + spins.zeeman_i) / 2;
  const DrivenLevels driven(spins, {{0, 0.2, field, drive(positive, h1, per_tesla * field)}}, slowest);
  for (const double s : {2e-3, 4.4e-3}) {
    const double p = rabi(two_pi * per_tesla * h1, 0, 0.2 * s);
    const Eigen::MatrixXd expected = test::probabilities(majorana_table(2), p);
    const Eigen::MatrixXd got = test::probabilities(driven, s);
    for (int from = 0; from < 3; ++from)
      for (int to = 0; to < 3; ++to) EXPECT_NEAR(got(from, to), expected(from, to), 2e-4);
    EXPECT_NEAR(got(3, 3), 1, 1e-9);
  }
}

TEST(DrivenLevels, OfBothHyperfineManifoldsTurnInOppositeSenses) {
  const CoupledSpins spins = coupled_spins(*find_atom("Na-23"));
  const double field = 5e-6, h1 = 2e-8, s = 4e-3;
  // g_F = +-g_J/4 for F = 2, 1, apart from the nucleus
  const double upper = spins.zeeman_i + (spins.zeeman_j - spins.zeeman_i) / 4;
  const double lower = spins.zeeman_i - (spins.zeeman_j - spins.zeeman_i) / 4;
  for (const auto& [kind, twice_spin, first, per_tesla] :
       {std::tuple{positive, 4, 0, upper}, std::tuple{negative, 2, 5, -lower}}) {
    const DrivenLevels driven(spins, {{0, 0.3, field, drive(kind, h1, per_tesla * field)}}, slowest);
    const Eigen::MatrixXd p = test::probabilities(driven, s);
    const Eigen::MatrixXd expected =
        test::probabilities(majorana_table(twice_spin), rabi(two_pi * per_tesla * h1, 0, 0.3 * s));
    for (int from = 0; from <= twice_spin; ++from)
      for (int to = 0; to <= twice_spin; ++to)
        EXPECT_NEAR(p(first + from, first + to), expected(from, to), 2e-3);
    for (int other = 0; other < 8; ++other)
      if (other < first || other > first + twice_spin) {
        EXPECT_NEAR(p(other, other), 1, 2e-4);
      }
  }
}

TEST(DrivenLevels, AgreeWithTheLaboratoryForEveryRotatingField) {
  for (const auto& [twice_i, twice_j] : {std::pair{1, 1}, {3, 1}, {2, 2}, {3, 3}}) {
    const CoupledSpins spins = small_atom(twice_i, twice_j);
    // Strong fields on two locked clocks; the second is also in the third zone, with another static field.
    const std::vector<LevelZone> zones{{0.01, 0.02, 6e-6, drive(positive, 1e-6, 6e4, 0.4)},
                                       {0.02, 0.025, 2e-5, std::nullopt},
                                       {0.025, 0.035, 2e-5, on_clock(drive(negative, 2e-6, 9e4, 1.1), 1)},
                                       {0.035, 0.05, 4e-5, on_clock(drive(negative, 3e-6, 9e4, 2.9), 1)},
                                       {0.05, 0.06, 6e-6, drive(positive, 1e-6, 6e4, -0.8)}};
    const double s = 1.3e-3;
    const Eigen::MatrixXd p = test::probabilities(DrivenLevels(spins, zones, slowest), s);
    EXPECT_LT(difference(p, in_the_laboratory(spins, zones, s, 8000)), 1e-7)
        << "2I = " << twice_i << ", 2J = " << twice_j;
    expect_doubly_stochastic(p);
    std::vector<LevelZone> other = zones;
    other[3].drive->oscillator.phase += 0.03;
    EXPECT_GT(difference(p, test::probabilities(DrivenLevels(spins, other, slowest), s)), 1e-4);
  }
}

TEST(DrivenLevels, AgreeWithTheLaboratoryInFieldsAgainstTheAxisToo) {
  for (const auto& [twice_i, twice_j] : {std::pair{1, 1}, {3, 1}, {3, 3}}) {
    const CoupledSpins spins = small_atom(twice_i, twice_j);
    const std::vector<LevelZone> zones{{0.01, 0.02, -6e-6, drive(positive, 1e-6, 6e4, 0.4)},
                                       {0.02, 0.025, 0, std::nullopt},
                                       {0.025, 0.035, 2e-5, on_clock(drive(negative, 2e-6, 9e4, 1.1), 1)},
                                       {0.035, 0.04, 0, std::nullopt},
                                       {0.04, 0.05, -2e-5, drive(positive, 1e-6, 6e4, -0.8)}};
    const double s = 1.3e-3;
    const Eigen::MatrixXd p = test::probabilities(DrivenLevels(spins, zones, slowest), s);
    EXPECT_LT(difference(p, in_the_laboratory(spins, zones, s, 8000)), 1e-7)
        << "2I = " << twice_i << ", 2J = " << twice_j;
    std::vector<LevelZone> along = zones;
    along[0].field = 6e-6;
    EXPECT_GT(difference(p, test::probabilities(DrivenLevels(spins, along, slowest), s)), 1e-3);
  }
}

TEST(DrivenLevels, KeepTheirSignWhenTheFieldBetweenTwoZonesChanges) {
  const CoupledSpins spins = small_atom(3, 3);
  const Eigen::MatrixXd weak = levels_at(spins, 1e-6).states, strong = levels_at(spins, 1e-4).states;
  const Eigen::MatrixXd followed = states_after(spins, weak, 1e-6, 1e-4);
  EXPECT_GT(difference(followed, strong), 0.1) << "no sign changes here: choose other fields";
  EXPECT_LT((followed.transpose() * weak).diagonal().minCoeff(), -0.1) << "no state turns round";
  const std::vector<LevelZone> zones{{0.0, 0.01, 1e-6, drive(positive, 8e-6, 2e5)},
                                     {0.01, 0.015, 1e-4, drive(positive, 2e-5, 2e5)}};
  EXPECT_LT(difference(test::probabilities(DrivenLevels(spins, zones, slowest), 2e-3),
                       in_the_laboratory(spins, zones, 2e-3, 10000)),
            1e-6);
}

TEST(DrivenLevels, AgreeWithTheLaboratoryForOscillatingFieldsAsFarAsWhatIsNeglected) {
  const CoupledSpins spins = small_atom(3, 1);  // 400 kHz between F = 2 and F = 1
  const double field = 8e-6;
  const Levels levels = levels_at(spins, field);
  const int f1 = *find_weak_field_level(levels.labels, 2, 0);
  const int f2 = *find_weak_field_level(levels.labels, 4, 0),
            f22 = *find_weak_field_level(levels.labels, 4, 2);
  RotatingTerm slanted = drive(oscillating, 1, transition_frequency(levels, f1, f22) + 300, 0.3);
  slanted.first = {0.6, -0.8, 0};
  RotatingTerm pi = along_z(drive(oscillating, 1, transition_frequency(levels, f1, f2) + 100));
  RotatingTerm low = drive(oscillating, 1, transition_frequency(levels, f2, f22) + 100);
  for (const RotatingTerm& full : {slanted, pi, low}) {
    double error = 1;
    for (const double amplitude : {4e-7, 2e-7, 1e-7}) {  // pulses of one area
      const double length = 5e-9 / amplitude, s = 5e-3;
      RotatingTerm weak = full;
      weak.amplitude = amplitude;
      RotatingTerm second = weak;
      second.oscillator.phase += 1.2;
      const std::vector<LevelZone> zones{{0, length, field, weak},
                                         {length, 2 * length, field, std::nullopt},
                                         {2 * length, 3 * length, field, second}};
      const DrivenLevels driven(spins, zones, slowest);
      const Eigen::MatrixXd p = test::probabilities(driven, s);
      error = difference(p, in_the_laboratory(spins, zones, s, static_cast<int>(1e6 * length)));
      EXPECT_LT(error, 4 * driven.neglected());
      EXPECT_GT(driven.neglected(), 0);
      EXPECT_GT(1 - p(f1, f1) + 1 - p(f2, f2), 0.1);
    }
    EXPECT_LT(error, 0.01);
  }
}

TEST(DrivenLevels, UnderASmoothProfileAgreeWithTheWholeFieldAtAnyPhase) {
  const CoupledSpins spins = small_atom(3, 1);
  const double field = 8e-6, s = 5e-3, length = 0.06;
  const std::vector<LevelLabel> labels = level_labels(spins);
  const int upper = *find_weak_field_level(labels, 4, 2), lower = *find_weak_field_level(labels, 4, 0);
  const double f = transition_frequency(levels_at(spins, field), lower, upper);
  for (const double phase : {0.0, 1.3}) {
    const auto zones = [&](double amplitude) -> std::vector<LevelZone> {
      RotatingTerm swings = drive(oscillating, amplitude, f, phase);
      swings.first = {0.8, 0, 0.6};
      swings.envelope = {Shape::half_sine, 0, length, 0};
      return {{0, length, field, swings}};
    };
    const Eigen::MatrixXd whole = in_the_laboratory(spins, zones(1.5e-6), s, 30000);
    EXPECT_LT(difference(test::probabilities(DrivenLevels(spins, zones(1.5e-6), s), s), whole), 2e-3);
    EXPECT_GT(difference(test::probabilities(DrivenLevels(spins, zones(1.01 * 1.5e-6), s), s), whole), 5e-3);
  }
}

TEST(DrivenLevels, AgreeWithTheLaboratoryForOneClockInFieldsAlongAnyAxes) {
  // Transitions with dm = 0 and +-1 overlap: 7 kHz between neighbours of one F, 1 kHz of coupling.
  const CoupledSpins spins = small_atom(3, 1);
  const double field = 1e-6, s = 5e-3, f = transition_frequency(levels_at(spins, field), 6, 2) + 1500;
  RotatingTerm first = drive(oscillating, 1.6e-7, f, 0.3), second = drive(oscillating, 1.6e-7, f, 1.5);
  first.first = {0.6, -0.48, 0.64};
  second.first = {0.36, 0.8, -0.48};
  const auto zones = [&](double x, double y, double z) -> std::vector<LevelZone> {
    RotatingTerm other = second;
    other.first = {x, y, z};
    return {{0, 0.05, field, first}, {0.05, 0.06, field, std::nullopt}, {0.06, 0.11, 1.1e-6, other}};
  };
  const DrivenLevels driven(spins, zones(0.36, 0.8, -0.48), slowest);
  const Eigen::MatrixXd p = test::probabilities(driven, s);
  EXPECT_LT(driven.neglected(), 4e-3);
  EXPECT_LT(difference(p, in_the_laboratory(spins, zones(0.36, 0.8, -0.48), s, 8000)), 4e-3);
  for (const auto& mirrored : {zones(-0.36, 0.8, -0.48), zones(0.36, -0.8, -0.48), zones(0.36, 0.8, 0.48)})
    EXPECT_GT(difference(p, test::probabilities(DrivenLevels(spins, mirrored, slowest), s)), 0.01);
}

TEST(DrivenLevels, InAnOscillatingFieldDoNotKnowTheSignOfItsFrequency) {
  const auto p = [](double sign) {
    const RotatingTerm first = drive(oscillating, 2e-7, sign * 2.8e7),
                       second = drive(oscillating, 2e-7, sign * 2.8e7, sign * 0.8);
    return test::probabilities(
        DrivenLevels(half(), {{0, 0.04, 1.00002e-3, first}, {0.1, 0.14, 1.00002e-3, second}}, slowest), 2e-3);
  };
  EXPECT_LT(difference(p(1), p(-1)), 2e-11);
}

TEST(DrivenLevels, OfTwoLevelsSeeHalfOfAnOscillatingFieldTurnAndAreShiftedByTheOther) {
  const double larmor = 2.8e10 * 1e-3, frequency = larmor + 900, half_coupling = 1400;
  const double shift = 2 * half_coupling * half_coupling / (larmor + frequency);
  const auto turned = [&](double f) {
    const DrivenLevels turns(half(), {{0, 0.1, 1e-3, drive(positive, 1e-7, f)}}, slowest);
    return test::probabilities(turns, 2e-3);
  };
  const DrivenLevels swings(half(), {{0, 0.1, 1e-3, drive(oscillating, 2e-7, frequency)}}, slowest);
  EXPECT_LT(difference(turned(frequency - shift), test::probabilities(swings, 2e-3)), 1e-8);
  EXPECT_GT(difference(turned(frequency - 0.99 * shift), test::probabilities(swings, 2e-3)), 1e-7);
  EXPECT_NEAR(swings.neglected() / (half_coupling / (larmor + frequency)), 1, 1e-12);
}

TEST(DrivenLevels, ThatALongitudinalFieldModulatesCountAsNeglected) {
  // (g_F - g_F') m differs only by the nucleus for dm_F = 0, so take H at a field where the states are mixed.
  const CoupledSpins spins = coupled_spins(*find_atom("H"));
  const Levels levels = levels_at(spins, 0.05);
  const double f = transition_frequency(levels, 3, 1);
  const DrivenLevels driven(spins, {{0, 0.1, 0.05, along_z(drive(oscillating, 1e-6, f))}}, slowest);
  const double modulation = (levels.moment[1] - levels.moment[3]) * 1e-6 / constants::planck;
  EXPECT_NEAR(driven.neglected() / (std::abs(modulation) / 2 / f), 1, 1e-9);
}

struct CaesiumClock {
  CoupledSpins spins = coupled_spins(*find_atom("Cs-133"));
  double field = 6e-6, v = 250, pulse = 0.01, drift = 3.75;
  double resonance = 9192631770 + 427.45e8 * field * field;
  double tau = pulse / v, between = drift / v, w1 = two_pi / (4 * tau);
  // mu between (3,0) and (4,0) is (g_J - g_I')/2 mu_B = h (zeeman_j - zeeman_i)/2
  double amplitude = w1 / two_pi * 2 / (spins.zeeman_j - spins.zeeman_i);
  int from = *find_weak_field_level(level_labels(spins), 6, 0),
      to = *find_weak_field_level(level_labels(spins), 8, 0);

  std::vector<LevelZone> zones(double detuning, double phase) const {
    return {{1, 1 + pulse, field, along_z(drive(oscillating, amplitude, resonance + detuning))},
            {1 + pulse, 1 + pulse + drift, field, std::nullopt},
            {1 + pulse + drift, 1 + 2 * pulse + drift, field,
             along_z(drive(oscillating, amplitude, resonance + detuning, phase))}};
  }
  double flip(double detuning, double phase = 0) const {
    return test::probabilities(DrivenLevels(spins, zones(detuning, phase), slowest), 1 / v)(from, to);
  }
};

TEST(DrivenLevels, OfTheCaesiumClockFollowRamseysFormulaOverOneHundredMillionCycles) {
  const CaesiumClock clock;
  EXPECT_NEAR(clock.flip(0), 1, 1e-6);
  const double minimum = 1 / (2 * (clock.between + 4 * clock.tau / (two_pi / 2)));
  EXPECT_LT(clock.flip(minimum), 1e-6);
  EXPECT_LT(clock.flip(-minimum), 1e-6);
  EXPECT_GT(clock.flip(1.01 * minimum), 2e-4);
  for (const double detuning : {-70.0, -12.5, 3.3, 41.0, 900.0})
    EXPECT_NEAR(clock.flip(detuning), ramsey(clock.w1, two_pi * detuning, clock.tau, clock.between), 3e-5);
  const DrivenLevels driven(clock.spins, clock.zones(0, 0), slowest);
  EXPECT_LT(driven.neglected(), 1e-6);
  expect_doubly_stochastic(test::probabilities(driven, 1 / clock.v));
}

TEST(DrivenLevels, FollowRamseysFormulaAndAPhaseMovesItsFringes) {
  const double larmor = 2.8e10 * 1e-3, s = 2e-3, tau = 0.02 * s, between = 0.5 * s, w1 = two_pi / (4 * tau);
  const auto flip = [&](double off, double phase) {
    const RotatingTerm first = drive(positive, w1 / two_pi / 2.8e10, larmor + off);
    RotatingTerm second = first;
    second.oscillator.phase = phase;
    const std::vector<LevelZone> zones{
        {0, 0.02, 1e-3, first}, {0.02, 0.52, 1e-3, std::nullopt}, {0.52, 0.54, 1e-3, second}};
    return test::probabilities(DrivenLevels(half(), zones, slowest), s)(1, 0);
  };
  for (const double off : {-3000.0, -400.0, 0.0, 150.0, 2200.0})
    EXPECT_NEAR(flip(off, 0), ramsey(w1, two_pi * off, tau, between), 1e-8);
  for (const double phase : {0.5, -1.4, 3.0})
    EXPECT_NEAR(flip(0, phase), std::pow(std::cos(phase / 2), 2), 1e-9);
  // The spin gets ahead of the field by -D T; a field that is ahead by as much less D T finds it in phase.
  const double off = 200, ahead = -two_pi * off * (between + 2 * 2 * tau / (two_pi / 2));
  EXPECT_NEAR(flip(off, ahead), 1, 2e-3);
  EXPECT_LT(flip(off, -ahead), 0.7);
}

TEST(DrivenLevels, AreFieldFreeInAGap) {
  // The gap's zero field detunes the spin by the whole frequency.
  const double larmor = 2.8e10 * 1e-6, s = 1e-3;
  const RotatingTerm field = drive(positive, 5e-7, larmor);
  const std::vector<LevelZone> gap{{0, 0.01, 1e-6, field}, {0.03, 0.04, 1e-6, field}};
  const std::vector<LevelZone> zero{
      {0, 0.01, 1e-6, field}, {0.01, 0.03, 0, std::nullopt}, {0.03, 0.04, 1e-6, field}};
  const std::vector<LevelZone> same{
      {0, 0.01, 1e-6, field}, {0.01, 0.03, 1e-6, std::nullopt}, {0.03, 0.04, 1e-6, field}};
  const auto p = [&](const std::vector<LevelZone>& zones) {
    return test::probabilities(DrivenLevels(half(), zones, slowest), s);
  };
  EXPECT_LT(difference(p(gap), p(zero)), 2e-11);
  EXPECT_LT(difference(p(gap), in_the_laboratory(half(), zero, s, 2000)), 1e-8);
  EXPECT_GT(difference(p(gap), p(same)), 0.1);
}

TEST(DrivenLevels, AgreeWithTheLaboratoryUnderEveryEnvelope) {
  const CoupledSpins spins = small_atom(1, 1);
  for (const Shape shape : {Shape::half_sine, Shape::gaussian}) {
    RotatingTerm field = drive(positive, 1.5e-6, 6e4, 0.2);
    field.envelope = {shape, 0.01, 0.06, 0.011};
    // one field over two static fields
    const std::vector<LevelZone> zones{{0.01, 0.03, 8e-6, field}, {0.03, 0.07, 9e-6, field}};
    const double s = 2e-3;
    const Eigen::MatrixXd expected = in_the_laboratory(spins, zones, s, 8000);
    const Eigen::MatrixXd p = test::probabilities(DrivenLevels(spins, zones, s), s);
    EXPECT_LT(difference(p, expected), 1e-7);
    EXPECT_GT(1 - p(0, 0), 0.1);
    expect_doubly_stochastic(p);
    const Eigen::MatrixXd fast = test::probabilities(DrivenLevels(spins, zones, s), s / 3);
    EXPECT_LT(difference(fast, in_the_laboratory(spins, zones, s / 3, 4000)), 1e-7);
  }
}

}  // namespace
}  // namespace rabiline::driven_levels_test
