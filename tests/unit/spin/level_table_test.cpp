// Energies and couplings of levels along a field of either sign, as kernels read them.
#include "spin/level_table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/constants.hpp"
#include "particle/species.hpp"
#include "spin/levels.hpp"

namespace rabiline::level_table_test {
namespace {

/// A row of numbers at a field.
std::vector<double> row_at(const LevelManifold& f, double field) {
  const double place = (std::atan(field / f.scale) / std::numbers::pi + 0.5) * f.cells;
  const int cell = std::min(static_cast<int>(place), f.cells - 1);
  const double x = 2 * (place - cell) - 1;
  std::vector<double> row(static_cast<std::size_t>(f.width));
  for (int i = 0; i < f.width; ++i)
    for (int power = level_powers - 1; power >= 0; --power)
      row[static_cast<std::size_t>(i)] =
          row[static_cast<std::size_t>(i)] * x + f.rows[(cell * level_powers + power) * f.width + i];
  return row;
}
/// [Hz] of a level from the mean of its manifold.
std::vector<double> energies_at(const LevelManifold& f, double field) {
  std::vector<double> row = row_at(f, field);
  row.resize(static_cast<std::size_t>(f.levels));
  for (double& energy : row)
    energy *= std::sqrt(1 + field * field / f.scale / f.scale) / (2 * std::numbers::pi);
  return row;
}
std::vector<double> expected_at(const CoupledSpins& spins, const LevelManifold& f, double field,
                                bool mirrored) {
  const Levels levels = levels_at(spins, field);
  std::vector<double> energy;
  double mean = 0;
  for (int k = 0; k < f.levels; ++k) {
    energy.push_back(levels.energy[static_cast<std::size_t>((mirrored ? f.mirror : f.number)[k])] /
                     constants::planck);
    mean += energy.back() / f.levels;
  }
  for (double& e : energy) e -= mean;
  return energy;
}

TEST(LevelTable, HasTheEnergiesOfTheLevelsInFieldsOfEitherSign) {
  for (const char* atom : {"H atom", "Cs-133 atom", "Ag-107 atom", "ortho-H2"}) {
    const CoupledSpins spins = coupled_spins(*find_species(atom)->structure);
    const LevelTable table(spins, manifolds_of(spins, 1e6));
    for (const LevelManifold& f : table.manifolds())
      for (const double field : {1e-7, 1e-5, 1e-3, 0.05, 1.0}) {
        const std::vector<double> up = energies_at(f, field), down = energies_at(f, -field),
                                  expected = expected_at(spins, f, field, false),
                                  mirrored = expected_at(spins, f, field, true);
        for (std::size_t k = 0; k < expected.size(); ++k) {
          const double digits = 1e-12 * (std::abs(expected[k]) + 14e9 * (f.scale + field));
          EXPECT_NEAR(up[k], expected[k], digits) << atom << field;
          EXPECT_NEAR(down[k], mirrored[k], digits) << atom << field;
        }
      }
  }
}

TEST(LevelTable, CouplesTheLevelsOfOneFAsASpinAtZeroField) {
  const CoupledSpins spins = coupled_spins(*find_species("K-39 atom")->structure);
  const LevelTable table(spins, manifolds_of(spins, 1e6));
  for (const LevelManifold& f : table.manifolds()) {
    EXPECT_TRUE(f.is_chain);
    const std::vector<double> row = row_at(f, 0);
    const double spin = (f.levels - 1) / 2.0;
    for (int j = 0; j < f.couplings; ++j) {
      const double m = f.m[f.from[j]];
      EXPECT_NEAR(std::abs(row[static_cast<std::size_t>(f.levels + j)]),
                  std::sqrt(spin * (spin + 1) - m * (m - 1)), 1e-10);
    }
  }
}

TEST(LevelTable, TakesFThatAreNearTogether) {
  const CoupledSpins hydrogen = coupled_spins(*find_species("H atom")->structure);
  EXPECT_EQ(manifolds_of(hydrogen, 1e6), (std::vector<int>{1, 1, 1, 0}));
  EXPECT_EQ(manifolds_of(hydrogen, 2e9), (std::vector<int>{0, 0, 0, 0}));
}

}  // namespace
}  // namespace rabiline::level_table_test
