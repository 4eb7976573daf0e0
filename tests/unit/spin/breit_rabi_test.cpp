#include "spin/breit_rabi.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/constants.hpp"
#include "spin/levels.hpp"

namespace rabiline::breit_rabi_test {
namespace {

using constants::bohr_magneton;
using constants::planck;

/// The largest relative difference in energy or moment over all levels, 0.1 mT to 1 T. A value close to its
/// zero is compared as if it were a thousandth of the splitting or of mu_B.
double disagreement(const HyperfineAtom& closed, const HyperfineAtom& diagonalised) {
  const double least_energy = 1e-3 * planck * std::abs(closed.hyperfine_constant);
  double worst = 0;
  for (int step = 0; step <= 40; ++step) {
    const double field = 1e-4 * std::pow(10, step / 10.0);
    const Levels levels = levels_at(coupled_spins(diagonalised), field);
    for (std::size_t n = 0; n < levels.labels.size(); ++n) {
      const BreitRabi level = breit_rabi(closed, levels.labels[n].twice_f, levels.labels[n].twice_m, field);
      worst = std::max(
          {worst, std::abs(level.energy - levels.energy[n]) / std::max(std::abs(level.energy), least_energy),
           std::abs(level.moment - levels.moment[n]) /
               std::max(std::abs(level.moment), 1e-3 * bohr_magneton)});
    }
  }
  return worst;
}

TEST(BreitRabi, AgreesWithDiagonalisationForEveryAtomFromATenthOfAMilliteslaToOneTesla) {
  for (const HyperfineAtom& atom : atom_library()) {
    EXPECT_LE(disagreement(atom, atom), 1e-9) << atom.name;
  }
}

TEST(BreitRabi, DisagreesWithDiagonalisationWhenAnyConstantIsOnePercentOff) {
  for (const HyperfineAtom& atom : atom_library())
    for (double HyperfineAtom::*constant :
         {&HyperfineAtom::hyperfine_constant, &HyperfineAtom::g_j, &HyperfineAtom::g_i}) {
      HyperfineAtom off = atom;
      off.*constant *= 1.01;
      EXPECT_GT(disagreement(off, atom), 1e-7) << atom.name;
    }
}

TEST(BreitRabi, HasStraightStretchedLevelsOnBothSidesOfTheTurningPointOfTheRoot) {
  for (const char* name : {"K-39", "Ag-107"}) {
    const HyperfineAtom& atom = *find_atom(name);
    const int top = atom.twice_i + 1;
    for (const int m : {top, -top})
      for (const double field : {0.0, 1e-3, 0.05, 2.0}) {
        const double spin = atom.twice_i / 2.0, side = m > 0 ? 1 : -1;
        const double moment = -side * bohr_magneton * (atom.g_j / 2 + spin * atom.g_i);
        const BreitRabi level = breit_rabi(atom, top, m, field);
        EXPECT_NEAR(level.moment, moment, 1e-15 * bohr_magneton);
        // A I.J = A I/2 in a stretched state
        const double expected = planck * atom.hyperfine_constant * spin / 2 - moment * field;
        EXPECT_NEAR(level.energy, expected, 1e-13 * planck * std::abs(atom.hyperfine_constant)) << name;
      }
  }
}

TEST(BreitRabi, WithoutCouplingIsThatOfTwoFreeMoments) {
  HyperfineAtom atom = *find_atom("Na-23");
  atom.hyperfine_constant = 0;
  for (const double field : {0.0, 0.3}) {
    const Levels levels = levels_at(coupled_spins(atom), field);
    for (std::size_t n = 0; n < levels.labels.size(); ++n) {
      const BreitRabi level = breit_rabi(atom, levels.labels[n].twice_f, levels.labels[n].twice_m, field);
      EXPECT_NEAR(level.energy, levels.energy[n], 1e-14 * bohr_magneton);
      EXPECT_NEAR(level.moment, levels.moment[n], 1e-14 * bohr_magneton);
    }
  }
}

TEST(BreitRabi, GivesThePublishedQuadraticShiftsOfClockLines) {
  constexpr double per_gauss = 1e-8;  // Hz/T^2 in Hz/G^2
  const struct {
    const char* name;
    double shift, tolerance;
  } rows[] = {{"Cs-133", 427.45, 0.005}, {"H", 2773.0, 0.05}, {"Rb-87", 575.15, 0.01}};
  for (const auto& [name, shift, tolerance] : rows) {
    HyperfineAtom atom = *find_atom(name);
    EXPECT_NEAR(clock_quadratic_shift(atom) * per_gauss, shift, tolerance) << name;
    atom.g_j *= 1.01;
    EXPECT_GT(std::abs(clock_quadratic_shift(atom) * per_gauss - shift), tolerance) << name;
  }
}

TEST(BreitRabi, HasTheQuadraticShiftThatDiagonalisedClockLinesShow) {
  for (const HyperfineAtom& atom : atom_library()) {
    if (atom.twice_i % 2 == 0) continue;                                   // no m_F = 0
    const double gauss = std::abs(atom.hyperfine_constant) / 28e9 * 1e-2;  // a small field for this atom
    const auto line = [&](double field) {
      const Levels levels = levels_at(coupled_spins(atom), field);
      return std::abs(transition_frequency(levels, *find_weak_field_level(levels.labels, atom.twice_i - 1, 0),
                                           *find_weak_field_level(levels.labels, atom.twice_i + 1, 0)));
    };
    const double measured = (line(gauss) - line(0)) / (gauss * gauss);
    EXPECT_NEAR(measured / clock_quadratic_shift(atom), 1, 1e-3) << atom.name;
  }
}

TEST(ZeroMomentField, IsTheRootOfTheDiagonalisedMomentForEveryLevelOfEveryAtom) {
  int found = 0;
  for (const HyperfineAtom& atom : atom_library()) {
    const CoupledSpins spins = coupled_spins(atom);
    const std::vector<LevelLabel> labels = level_labels(spins);
    for (int n = 0; n < spins.levels(); ++n) {
      const std::vector<double> numeric = zero_moment_fields(spins, n, 1e-5, 10);
      const auto closed = zero_moment_field(atom, labels[n].twice_f, labels[n].twice_m);
      if (labels[n].twice_m == 0) continue;  // its moment is 0 at B = 0
      ASSERT_EQ(numeric.size(), closed ? 1u : 0u) << atom.name << " level " << n;
      if (!closed) continue;
      ++found;
      EXPECT_NEAR(*closed / numeric[0], 1, 1e-10) << atom.name << " level " << n;
      EXPECT_GT(std::abs(breit_rabi(atom, labels[n].twice_f, labels[n].twice_m, 1.01 * *closed).moment),
                1e-4 * bohr_magneton);
    }
  }
  // I = 1: one pair, 3/2: one, 5/2: two, 7/2: three; D, Li-6; Li-7, Na, K-39, K-41, Rb-87; Rb-85; Cs
  EXPECT_EQ(found, 2 * (2 * 1 + 5 * 1 + 2 + 3));
}

TEST(ZeroMomentField, IsAtXEqualToMinusUWithoutANuclearMoment) {
  HyperfineAtom atom = *find_atom("Na-23");
  atom.g_i = 0;
  const double field = planck * 1771.626129e6 / (2 * atom.g_j * bohr_magneton);  // x = 1/2, for m_F = -1
  EXPECT_NEAR(*zero_moment_field(atom, 4, -2) / field, 1, 1e-12);
  EXPECT_NEAR(*zero_moment_field(atom, 2, -2) / field, 1, 1e-12);
  EXPECT_GT(std::abs(*zero_moment_field(*find_atom("Na-23"), 4, -2) / field - 1), 1e-4);
}

TEST(ZeroMomentField, LiesAtPositiveMInAnInvertedStructure) {
  HyperfineAtom atom = *find_atom("Na-23");
  atom.hyperfine_constant *= -1;
  EXPECT_TRUE(zero_moment_field(atom, 4, 2));
  EXPECT_FALSE(zero_moment_field(atom, 4, -2));
  const int n = *find_weak_field_level(level_labels(coupled_spins(atom)), 4, 2);
  const std::vector<double> numeric = zero_moment_fields(coupled_spins(atom), n, 1e-5, 10);
  ASSERT_EQ(numeric.size(), 1u);
  EXPECT_NEAR(*zero_moment_field(atom, 4, 2) / numeric[0], 1, 1e-10);
}

TEST(ZeroMomentField, DoesNotExistForStretchedLevelsAndForMZero) {
  const HyperfineAtom& atom = *find_atom("Cs-133");
  EXPECT_FALSE(zero_moment_field(atom, 8, 8));
  EXPECT_FALSE(zero_moment_field(atom, 8, -8));
  EXPECT_FALSE(zero_moment_field(atom, 8, 0));
  EXPECT_FALSE(zero_moment_field(atom, 8, 2));
}

}  // namespace
}  // namespace rabiline::breit_rabi_test
