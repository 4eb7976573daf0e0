#pragma once
// Magnets and particles for tests of stepped paths.
#include <random>

#include "constants.hpp"
#include "transport/stages/steering.hpp"

namespace rabiline::steering_test {

using test::atomic_mass;
using test::bohr_magneton;

inline MagnetShape multipole(int power, double field = 1, double radius = 5e-3) {
  MagnetShape shape;
  shape.kind = MagnetKind::multipole;
  shape.power = power;
  shape.field = field;
  shape.radius = radius;
  return shape;
}

inline Steering magnet(const MagnetShape& shape, double length = 0.2) {
  Steering s;
  s.begin = 0.1;
  s.end = 0.1 + length;
  s.shape = shape;
  s.mass = 132.905 * atomic_mass;
  s.moment = -bohr_magneton;
  s.levels = 2;
  return s;
}

/// Particles spread over a few mm and mm/m around the beam, of 150 to 1000 m/s, in both levels.
inline void fill(Batch& batch, int levels, double spread = 2e-3) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> even(-1, 1);
  BatchView& v = batch.view();
  v.count = v.padded = Batch::capacity;
  v.y = 0.1;
  for (int i = 0; i < v.count; ++i) {
    v.x[i] = spread * even(random);
    v.z[i] = spread * even(random);
    v.vy[i] = 575 + 425 * even(random);
    v.slowness[i] = 1 / v.vy[i];
    v.vx[i] = 5 * even(random);
    v.vz[i] = 5 * even(random);
    v.t[i] = 1e-3;
    v.sx[i] = v.sy[i] = 0;
    v.sz[i] = even(random);
    v.level[i] = static_cast<std::uint64_t>(i % levels);
    v.weight[i] = 1;
    v.particle[i] = static_cast<std::uint64_t>(i);
    v.flying[i] = ~std::uint64_t{0};
    v.caught_by[i] = 0;
  }
}

}  // namespace rabiline::steering_test
