#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/constants.hpp"
#include "particle/species.hpp"
#include "spin/levels.hpp"

namespace rabiline::ortho_hydrogen_test {
namespace {

constexpr double proton = 42.577478461e6, rotation = 6.71e6;  // [Hz/T]
constexpr double c = 113.904e3, d = 57.671e3;                 // [Hz]

/// Frequencies m_I -> m_I - 1 less the proton's, at each m_J, in hertz from below.
std::vector<double> lines_about_the_proton_frequency(const CoupledSpins& spins, double field) {
  const Levels levels = levels_at(spins, field);
  std::vector<double> lines;
  for (const int m_j : {-2, 0, 2})
    for (const int m_i : {2, 0}) {
      const int from = *find_strong_field_level(levels.labels, m_j, m_i);
      const int to = *find_strong_field_level(levels.labels, m_j, m_i - 2);
      lines.push_back(transition_frequency(levels, from, to) - proton * field);
    }
  std::ranges::sort(lines);
  return lines;
}

// First order in c and d: I.J has the expectation m_I m_J, and the term in d, which is
// d (3 m_I^2 - 2)(3 m_J^2 - 2)/2 there, changes by -+(3/2) d (3 m_J^2 - 2) for m_I = 1 -> 0 and 0 -> -1.
// The lines are c m_J -+ (3/2) d (3 m_J^2 - 2). Second order is about (c + d)^2 / (36 MHz/T B).
std::vector<double> first_order() {
  std::vector<double> lines;
  for (const int m_j : {-1, 0, 1})
    for (const int side : {-1, 1}) lines.push_back(c * m_j + side * 1.5 * d * (3 * m_j * m_j - 2));
  std::ranges::sort(lines);
  return lines;
}

double worst(const std::vector<double>& a, const std::vector<double>& b) {
  double out = 0;
  for (std::size_t k = 0; k < a.size(); ++k) out = std::max(out, std::abs(a[k] - b[k]));
  return out;
}

TEST(OrthoHydrogen, HasSixLinesAboutTheProtonFrequencyInAStrongField) {
  const double strong =
      worst(lines_about_the_proton_frequency(coupled_spins(*find_species("ortho-H2")->structure), 30),
            first_order());
  const double weaker =
      worst(lines_about_the_proton_frequency(coupled_spins(*find_species("ortho-H2")->structure), 3),
            first_order());
  EXPECT_LT(strong, 100);               // Hz
  EXPECT_NEAR(weaker / strong, 10, 1);  // what is left is of second order, like 1/B
}

TEST(OrthoHydrogen, MissesItsSixLinesWhenAConstantIsOnePercentOff) {
  CoupledSpins spin_rotation = coupled_spins(*find_species("ortho-H2")->structure),
               tensor = coupled_spins(*find_species("ortho-H2")->structure),
               moment = coupled_spins(*find_species("ortho-H2")->structure);
  spin_rotation.coupling -= 0.01 * c;
  add_quadrupole(tensor, 0.01 * d);
  moment.zeeman_i *= 1.01;
  for (const CoupledSpins& spins : {spin_rotation, tensor, moment})
    EXPECT_GT(worst(lines_about_the_proton_frequency(spins, 30), first_order()), 300);
}

TEST(OrthoHydrogen, HasTheRotationalMomentInItsLinesOfMJ) {
  const double field = 30;
  const Levels levels = levels_at(coupled_spins(*find_species("ortho-H2")->structure), field);
  // m_I = 0: m_J = 1 -> 0 and 0 -> -1, first order: b B +- (-1)(3/2) d (3 0 - 2)
  const double up = transition_frequency(levels, *find_strong_field_level(levels.labels, 2, 0),
                                         *find_strong_field_level(levels.labels, 0, 0));
  const double down = transition_frequency(levels, *find_strong_field_level(levels.labels, 0, 0),
                                           *find_strong_field_level(levels.labels, -2, 0));
  EXPECT_NEAR((up + down) / 2 / field, rotation, 1e-6 * rotation);
  EXPECT_NEAR((up - down) / 2, 3 * d, 30);
}

// At B = 0, x = I.J is 1, -1, -2 for F = 2, 1, 0, and E/h = -c x + d (3x^2 + 1.5x - 4).
TEST(OrthoHydrogen, HasThreeLevelsAtZeroField) {
  const Levels levels = levels_at(coupled_spins(*find_species("ortho-H2")->structure), 0);
  const double expected[] = {2 * c + 5 * d, c - 2.5 * d, -c + 0.5 * d};
  for (int f = 0; f <= 2; ++f)
    for (int m = -f; m <= f; ++m)
      EXPECT_NEAR(levels.energy[*find_weak_field_level(levels.labels, 2 * f, 2 * m)] / constants::planck,
                  expected[f], 1e-6);
}

}  // namespace
}  // namespace rabiline::ortho_hydrogen_test
