// Paths through magnets by the steps that a run takes, and by an independent integration of their force.
#include "simulation/magnet_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "core/isa.hpp"
#include "particle/species.hpp"
#include "spin/moment_table.hpp"
#include "unit/transport/steering_samples.hpp"

namespace rabiline::magnet_check_test {
namespace {

using steering_test::fill;
using steering_test::magnet;
using steering_test::multipole;

MagnetShape two_wires() {
  MagnetShape shape;
  shape.kind = MagnetKind::two_wire;
  shape.field = -0.5;
  shape.half_distance = 3e-3;
  shape.height = 3.6e-3;
  return shape;
}
MagnetShape gradient(double field, double slope) {
  MagnetShape shape;
  shape.field = field;
  shape.gradient = slope;
  shape.along_x = 0.6;
  shape.along_z = 0.8;
  return shape;
}

std::uint64_t fly(const Steering& s, BatchView& batch) { return kernel::steer(best_isa())(s, batch); }
std::uint64_t fly(const Deflection& d, BatchView& batch) { return kernel::deflect(best_isa())(d, batch); }

/// The largest deviation of place, over the length, and direction of what flies through one magnet from the
/// integration of another.
template <class Magnet>
double worst(const Magnet& flown, const Magnet& integrated, double spread = 1e-3) {
  Batch before, behind;
  fill(before, std::max(flown.levels, 1), spread);
  before.view().fall = {0.3, -9.8};
  behind.copy_from(before);
  fly(flown, behind.view());
  const BatchView &b = before.view(), &a = behind.view();
  double largest = 0;
  long evaluations = 0;
  for (int i = 0; i < b.count; i += 5) {
    if (a.flying[i] == 0) continue;
    const auto there = integrated_through(integrated, b, i, evaluations, 10'000'000);
    if (!there) return NAN;
    largest = std::max({largest, std::hypot(there->x - a.x[i], there->z - a.z[i]) / (flown.end - flown.begin),
                        std::hypot(there->vx - a.vx[i], there->vz - a.vz[i]) / a.vy[i]});
  }
  return largest;
}

/// Turned and displaced.
std::vector<Steering> magnets() {
  std::vector<Steering> out;
  for (const MagnetShape& shape : {two_wires(), multipole(2), multipole(3), multipole(5)}) {
    Steering s = magnet(shape);
    s.x0 = 0.3e-3;
    s.z0 = -0.2e-3;
    s.cosine = std::cos(2.5);
    s.sine = std::sin(2.5);
    out.push_back(s);
  }
  return out;
}
Steering of_an_atom(const MomentTable& table) {
  Steering s = magnet(gradient(0.4, 100));
  s.levels = table.levels();
  s.moment = table.largest();
  s.moments = {table.coefficients().data(), table.cells(), table.scale()};
  return s;
}

TEST(MagnetReference, IsWhatIsFlownAndWouldNotBeIfTheForceWereAPercentMore) {
  const MomentTable table(coupled_spins(*find_species("Cs-133 atom")->structure));
  std::vector<Steering> all = magnets();
  all.push_back(of_an_atom(table));
  for (const Steering& s : all) {
    EXPECT_LT(worst(s, s), s.tolerance) << static_cast<int>(s.shape.kind) << ' ' << s.shape.power;
    Steering stronger = s;
    stronger.mass /= 1.01;
    EXPECT_GT(worst(s, stronger), 10 * s.tolerance) << static_cast<int>(s.shape.kind) << ' ' << s.shape.power;
  }
  Deflection d;
  d.begin = 0.1;
  d.end = 0.3;
  d.levels = 2;
  d.acceleration = 5e3;
  d.along_x = 0.6;
  d.along_z = 0.8;
  EXPECT_LT(worst(d, d), 1e-12);
  Deflection stronger = d;
  stronger.acceleration *= 1.01;
  EXPECT_GT(worst(d, stronger), 10 * d.tolerance);
}

TEST(Steering, KeepsTheToleranceThatIsAskedForInPlaceAndDirection) {
  const MomentTable table(coupled_spins(*find_species("Cs-133 atom")->structure));
  std::vector<Steering> all = magnets();
  all.push_back(of_an_atom(table));
  double worst_of_usual = 0;
  for (Steering& s : all) {
    if (s.levels == 2) s.mass /= 4;  // oscillations
    if (s.shape.kind == MagnetKind::multipole) s.walls.circles[0] = {0, 0, 5e-3, -1};
    if (s.shape.kind == MagnetKind::two_wire)
      s.walls.circles[0] = {3e-3, 0, 2e-3, 1}, s.walls.circles[1] = {-3e-3, 0, 2e-3, 1};
    worst_of_usual = std::max(worst_of_usual, worst(s, s));
    for (const double tolerance : {1e-8, 1e-10}) {
      s.tolerance = tolerance;
      EXPECT_LT(worst(s, s), tolerance) << static_cast<int>(s.shape.kind) << ' ' << s.shape.power;
    }
  }
  EXPECT_GT(worst_of_usual, 1e-9);  // so that there was something to keep
  EXPECT_LT(worst_of_usual, 1e-6);
}

TEST(Steering, TakesNoMoreThanSoMuchWorkInAnyGradient) {
  const MomentTable table(coupled_spins(*find_species("Cs-133 atom")->structure));
  Steering s = of_an_atom(table);
  s.shape = gradient(1, -1e9);
  Batch batch;
  fill(batch, s.levels);
  batch.view().count = batch.view().padded = 16;
  const std::clock_t begin = std::clock();
  fly(s, batch.view());
  stops_of(s, {0, 15}, 300);
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 4);  // minutes, if each were followed
}

TEST(Steering, TellsWorkThatGrowsWithTheGradientUpToThat) {
  const MomentTable table(coupled_spins(*find_species("Cs-133 atom")->structure));
  Steering s = of_an_atom(table);
  EXPECT_LT(outlook_of(s, 300).steps, 100);
  s.shape = gradient(1, -1e9);
  EXPECT_EQ(outlook_of(s, 300).steps, steering::most_steps + steering::most_fine);
}

}  // namespace
}  // namespace rabiline::magnet_check_test
