// What the rotating-wave approximation leaves out.
#include "spin/rotating_frame.hpp"

#include <gtest/gtest.h>

#include "drives.hpp"
#include "spin/atoms.hpp"
#include "spin/level_labels.hpp"
#include "spin/levels.hpp"

namespace rabiline {
namespace {

double shift_of(const CoupledSpins& spins, double field, const RotatingTerm& drive, int upper, int lower) {
  return counter_rotating_shift(driven_states(spins, levels_at(spins, field), drive),
                                drive.oscillator.frequency, upper, lower);
}

// A field 2 H1 cos(w t) holds H1 that turns with the spin and H1 that turns against it: dw = (gamma H1)^2/(4
// w0) (F. Bloch, A. Siegert, Phys. Rev. 57, 522 (1940)), here gamma H1 = 2 pi C and w0 = 2 pi f.
TEST(CounterRotatingShift, OfTwoLevelsIsThatOfBlochAndSiegert) {
  const double field = 1e-3, h1 = 2e-6, f = half().zeeman_j * field, c = half().zeeman_j * h1;
  const double found = shift_of(half(), field, drive(oscillating, 2 * h1, f), 0, 1);
  EXPECT_NEAR(found, c * c / (4 * f), 1e-9 * found);
  EXPECT_NEAR(shift_of(half(), field, drive(oscillating, 2 * h1, 2 * f), 0, 1), found * 2 / 3, 1e-9 * found);
}

TEST(CounterRotatingShift, OfPotassiumInThirtyGaussGrowsToTwentyKilohertz) {
  const CoupledSpins spins = coupled_spins(*find_atom("K-39"));
  const double field = 30e-4;
  const std::vector<LevelLabel> labels = level_labels(spins);
  const int upper = *find_weak_field_level(labels, 4, -2), lower = *find_weak_field_level(labels, 4, -4);
  EXPECT_NEAR(shift_of(spins, field, drive(oscillating, 60e-6, 18.4e6), upper, lower), 0.80e3, 5);
  EXPECT_NEAR(shift_of(spins, field, drive(oscillating, 300e-6, 18.4e6), upper, lower), 19.9e3, 50);
}

}  // namespace
}  // namespace rabiline
