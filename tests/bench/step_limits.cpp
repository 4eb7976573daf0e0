// Steps of spins in a field that turns, and of paths between two wires, by bare arithmetic.
#include <immintrin.h>

#include "bench/limits.hpp"
#include "transport/vector_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

constexpr int packs_in_flight = 2, paths_in_flight = 4;

/// Spin, and the field's direction at the first Gauss point of the step to come.
struct Spin {
  Vector s;
  Phasor field;
};
/// Of one step: the turning from its first Gauss point to its second, and to the next step's first.
struct Turning {
  Phasor inside, whole;
  real w0, w1, h;
};
RABILINE_LANES void step(const Turning& by, Spin& spin) {
  const Phasor second = spin.field * by.inside;
  const Vector a{by.w1 * spin.field.c, by.w1 * spin.field.s, by.w0},
      b{by.w1 * second.c, by.w1 * second.s, by.w0};
  spin.s = rotate(magnus(a, b, by.h), spin.s);
  spin.field = spin.field * by.whole;
}

/// 1/sqrt(q) from an estimate of 14 bits and two steps of Newton's.
RABILINE_LANES real over_root(real q) {
  real y = _mm512_rsqrt14_pd(q);
  for (int i = 0; i < 2; ++i) y = y * (1.5 - 0.5 * q * y * y);
  return y;
}

struct ByHand {
  double a, strength;
  /// One root of r1^2 r2^2 gives |B| and both of its slopes.
  RABILINE_LANES void operator()(real x, real z, real& along_x, real& along_z) const {
    const real right = x - a, left = x + a, z2 = z * z, q1 = right * right + z2, q2 = left * left + z2;
    const real over = over_root(q1 * q2), over2 = over * over, near = q2 * over2, far = q1 * over2;
    const real size = strength * over;
    along_x = -size * (right * near + left * far);
    along_z = -size * z * (near + far);
  }
};
struct AsFlown {
  const MagnetShape& shape;
  RABILINE_LANES void operator()(real x, real z, real& along_x, real& along_z) const {
    const auto field = field_size(shape, x, z, [](real q) { return sqrt(q); });
    along_x = field.along_x;
    along_z = field.along_z;
  }
};

template <class Slopes>
double leapfrog(const Slopes& slopes, double pull, double x, double z, double h, int steps, int packs) {
  struct Path {
    real x, z, vx, vz;
  };
  double end = 0;
  for (int pack = 0; pack < packs; pack += paths_in_flight) {
    Path path[paths_in_flight];
    for (Path& p : path) {
      p = {broadcast(x), broadcast(z), real{}, real{}};
      asm volatile("" : "+v"(p.x));  // packs that start alike must not become one
    }
    for (int i = 0; i < steps; ++i)
      for (Path& p : path) {
        p.x = p.x + 0.5 * h * p.vx;
        p.z = p.z + 0.5 * h * p.vz;
        real along_x, along_z;
        slopes(p.x, p.z, along_x, along_z);
        p.vx = p.vx - (pull * h) * along_x;
        p.vz = p.vz - (pull * h) * along_z;
        p.x = p.x + 0.5 * h * p.vx;
        p.z = p.z + 0.5 * h * p.vz;
      }
    for (const Path& p : path) asm volatile("" : : "v"(p.x), "v"(p.z));
    end = lane(path[0].z, 0);
  }
  return end;
}

}  // namespace
}  // namespace rabiline::RABILINE_ISA

namespace rabiline::bench {

using namespace rabiline::RABILINE_ISA;

double magnus_spin(double w0, double w1, double omega, double h, int steps, int packs) {
  const auto turned = [&](double share) { return phasor(broadcast(omega * share * h)); };
  const Turning turning{turned(gauss_second - gauss_first), turned(1), broadcast(w0), broadcast(w1),
                        broadcast(h)};
  double end = 0;
  for (int pack = 0; pack < packs; pack += packs_in_flight) {
    Spin spin[packs_in_flight];
    for (Spin& s : spin) {
      s = {{real{}, real{}, broadcast(1)}, turned(gauss_first)};
      asm volatile("" : "+v"(s.s.x));
    }
    for (int i = 0; i < steps; ++i)
      for (Spin& s : spin) step(turning, s);
    for (const Spin& s : spin) asm volatile("" : : "v"(s.s.x), "v"(s.s.y), "v"(s.s.z));
    end = lane(spin[0].s.z, 0);
  }
  return end;
}

double wires_by_hand(const MagnetShape& shape, double pull, double x, double z, double h, int steps,
                     int packs) {
  const double a = shape.half_distance;
  return leapfrog(ByHand{a, shape.field * (a * a + shape.height * shape.height)}, pull, x, z, h, steps,
                  packs);
}
double wires_as_flown(const MagnetShape& shape, double pull, double x, double z, double h, int steps,
                      int packs) {
  return leapfrog(AsFlown{shape}, pull, x, z, h, steps, packs);
}

}  // namespace rabiline::bench
