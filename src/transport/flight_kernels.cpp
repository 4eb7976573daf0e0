// Straight flight: emission, drifts, openings, screens, alignment.
#include "transport/kernel_functions.hpp"
#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

constexpr double two_pi = 6.283185307179586;

RABILINE_LANES real uniform_pair(words particle, const RandomKey& key, unsigned use, unsigned draw,
                                 real& second) {
  real first;
  uniforms(particle, key.seed, use, draw, key.stream, first, second);
  return first;
}

/// Two independent standard normal variables from two uniform ones (Box and Muller 1958).
RABILINE_LANES void normal_pair(real u0, real u1, real& a, real& b) {
  const real r = sqrt(-2.0 * log(u0));
  const Phasor p = phasor(u1 * two_pi);
  a = r * p.c;
  b = r * p.s;
}

/// A point uniform in the opening.
RABILINE_LANES void draw_point(const Aperture& a, real u0, real u1, real& x, real& z) {
  if (a.radius >= 0) {
    const double inner2 = a.inner * a.inner;
    const real r = inner2 == 0 ? sqrt(u0) * a.radius
                               : sqrt(fma(u0, broadcast(a.radius * a.radius - inner2), broadcast(inner2)));
    const Phasor p = phasor(u1 * two_pi);
    x = fma(r, p.c, broadcast(a.x0));
    z = fma(r, p.s, broadcast(a.z0));
    return;
  }
  const real across = fma(u0, broadcast(2), broadcast(-1)) * a.half_x,
             up = fma(u1, broadcast(2), broadcast(-1)) * a.half_z;
  if (a.sine == 0) {
    x = across + a.x0;
    z = up + a.z0;
  } else {
    x = fma(across, broadcast(a.cosine), fma(up, broadcast(a.sine), broadcast(a.x0)));
    z = fma(up, broadcast(a.cosine), fma(across, broadcast(-a.sine), broadcast(a.z0)));
  }
}

std::uint64_t sum(words w) {
  std::uint64_t total = 0;
  for (int k = 0; k < lane_count; ++k) total += lane(w, k);
  return total;
}

RABILINE_LANES real normal_speed(const Emission& e, real u0, real u1) {
  real normal, unused;
  normal_pair(u0, u1, normal, unused);
  return fma(normal, broadcast(e.speed_sigma), broadcast(e.speed));
}
/// The parameters by value: a pointer to them would keep emit from holding them in registers.
[[gnu::noinline]] real redrawn(Emission e, words particle, real speed) {
  for (unsigned draw = 1; any(speed <= broadcast(0)); ++draw) {
    real u1;
    const real u0 = uniform_pair(particle, e.key, purpose::speed, draw, u1);
    speed = select(speed <= broadcast(0), normal_speed(e, u0, u1), speed);
  }
  return speed;
}
/// A normal law; speeds that are not positive are drawn again.
RABILINE_LANES void draw_speeds(const Emission& e, BatchView& batch) {
  if (e.speed_kind == SpeedKind::single) {
    for (int i = 0; i < batch.padded; i += lane_count) store(batch.vy + i, broadcast(e.speed));
    return;
  }
  alignas(64) double u0[Batch::capacity], u1[Batch::capacity];
  for (int i = 0; i < batch.padded; i += lane_count) {
    real second;
    store(u0 + i, uniform_pair(load(batch.particle + i), e.key, purpose::speed, 0, second));
    store(u1 + i, second);
  }
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real speed = normal_speed(e, load(u0 + i), load(u1 + i));
    const bool again = any(speed <= broadcast(0));
    store(batch.vy + i, again ? redrawn(e, load(batch.particle + i), speed) : speed);
  }
}

/// Slopes dx/dy and dz/dy, from the place of emission.
void draw_slopes(const Emission& e, words particle, real x, real z, real& slope_x, real& slope_z) {
  slope_x = slope_z = broadcast(0);
  if (e.direction == DirectionKind::parallel) return;
  if (e.direction == DirectionKind::gaussian) {
    real u1;
    const real u0 = uniform_pair(particle, e.key, purpose::direction, 0, u1);
    normal_pair(u0, u1, slope_x, slope_z);
    slope_x = slope_x * e.spread_x;
    slope_z = slope_z * e.spread_z;
    return;
  }
  real u1;
  const real u0 = uniform_pair(particle, e.key, purpose::direction, 0, u1);
  if (e.direction == DirectionKind::cone) {
    const real below = u0 * e.spread_x, cosine = 1.0 - below;  // below = 1 - cos(theta)
    const real tangent = sqrt(below * (1.0 + cosine)) / cosine;
    const Phasor p = phasor(u1 * two_pi);
    slope_x = tangent * p.c;
    slope_z = tangent * p.s;
    return;
  }
  real target_x, target_z;
  draw_point(e.target, u0, u1, target_x, target_z);
  slope_x = (target_x - x) / broadcast(e.target.y);
  slope_z = (target_z - z) / broadcast(e.target.y);
}

/// A particle starts in some level with its spin's image at +z, or with its spin anywhere on the sphere.
RABILINE_LANES void draw_spin(const Emission& e, words particle, int i, BatchView& batch) {
  real u1;
  const real u0 = uniform_pair(particle, e.key, purpose::spin, 0, u1);
  const real zero = broadcast(0);
  Vector s{zero, zero, broadcast(1)};
  words level = words{};
  if (e.levels > 0) {
    for (int k = 1; k < e.levels; ++k)
      level = level + select(u0 >= broadcast(static_cast<double>(k) / e.levels), broadcast_word(1), words{});
  } else {
    s.z = fma(u0, broadcast(2), broadcast(-1));
    const real transverse = sqrt(max(fma(-s.z, s.z, broadcast(1)), zero));
    const Phasor p = phasor(u1 * two_pi);
    s.x = transverse * p.c;
    s.y = transverse * p.s;
  }
  store(batch.sx + i, s.x);
  store(batch.sy + i, s.y);
  store(batch.sz + i, s.z);
  store(batch.level + i, level);
}

/// Isotropic emission towards a plane at distance D: dOmega = cos^3(theta) dA / D^2, as quanta of the axial
/// value.
RABILINE_LANES words weight_of(const Emission& e, real cosine) {
  if (e.direction != DirectionKind::aimed) return broadcast_word(quanta_per_particle);
  const real quanta = cosine * cosine * cosine * static_cast<double>(quanta_per_particle);
  return (words)(round_to_nearest(quanta) + 0x1p52) & 0xfffffffffffffULL;  // the integer in the low bits
}

/// Gives a speed, which stands in vy, its direction, and the particle its weight.
RABILINE_LANES void direct(const Emission& e, int i, BatchView& batch) {
  real slope_x, slope_z, cosine = broadcast(1);
  draw_slopes(e, load(batch.particle + i), load(batch.x + i), load(batch.z + i), slope_x, slope_z);
  if (e.direction != DirectionKind::parallel)
    cosine = 1.0 / sqrt(fma(slope_x, slope_x, fma(slope_z, slope_z, broadcast(1))));
  const real vy = load(batch.vy + i) * cosine;
  store(batch.vx + i, vy * slope_x);
  store(batch.vy + i, vy);
  store(batch.vz + i, vy * slope_z);
  store(batch.weight + i, weight_of(e, cosine) & load(batch.flying + i));
}

}  // namespace

// One short loop for each thing that is drawn: a processor holds several rounds of each at a time. The copies
// show the compiler that parameters do not change while columns are written.
void emit(const Emission& emission, std::uint64_t first_particle, BatchView& view) {
  view.y = 0;
  const Emission e = emission;
  BatchView batch = view;
  for (int i = 0; i < batch.padded; i += lane_count) {
    const words index = lane_numbers() + static_cast<unsigned long long>(i);
    const words particle = index + static_cast<unsigned long long>(first_particle);
    store(batch.particle + i, particle);
    real u1, x, z;
    const real u0 = uniform_pair(particle, e.key, purpose::place, 0, u1);
    draw_point(e.opening, u0, u1, x, z);
    store(batch.x + i, x);
    store(batch.z + i, z);
    store(batch.t + i, broadcast(0));
    store(batch.flying + i, (words)(index < broadcast_word(static_cast<unsigned long long>(batch.count))));
    store(batch.caught_by + i, words{});
  }
  draw_speeds(e, batch);
  for (int i = 0; i < batch.padded; i += lane_count) direct(e, i, batch);
  for (int i = 0; i < batch.padded; i += lane_count) draw_spin(e, load(batch.particle + i), i, batch);
}

void drift(double y, BatchView& batch) {
  const double way = y - batch.y;
  batch.y = y;
  if (way == 0) return;
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real dt = broadcast(way) / load(batch.vy + i);
    store(batch.x + i, fma(load(batch.vx + i), dt, load(batch.x + i)));
    store(batch.z + i, fma(load(batch.vz + i), dt, load(batch.z + i)));
    store(batch.t + i, load(batch.t + i) + dt);
  }
}

std::uint64_t pass(const Aperture& aperture, BatchView& batch) {
  words stopped = words{};
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real dt = broadcast(aperture.y - batch.y) / load(batch.vy + i);
    const real x = fma(load(batch.vx + i), dt, load(batch.x + i)),
               z = fma(load(batch.vz + i), dt, load(batch.z + i));
    const words through = (words)inside(aperture, x, z), flying = load(batch.flying + i);
    stopped = stopped + (load(batch.weight + i) & flying & ~through);
    store(batch.flying + i, flying & through);
  }
  return sum(stopped);
}

Caught screen(const Screen& screen, BatchView& batch) {
  const Aperture rim = rim_of(screen);
  words counted_weight = words{}, lost_weight = words{};
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real vy = load(batch.vy + i), dt = broadcast(screen.y - batch.y) / vy;
    const real x = fma(load(batch.vx + i), dt, load(batch.x + i)),
               z = fma(load(batch.vz + i), dt, load(batch.z + i));
    const words flying = load(batch.flying + i), hit = (words)inside(rim, x, z) & flying;
    const words caught = hit & ~(words)in_dead_area(screen, x, z);
    const words weight = load(batch.weight + i);
    words counted = weight;
    if (screen.efficiency != 1) {
      counted = weight_of(floor(number_of(weight) * screen.efficiency));
      store(batch.weight + i, select((mask)caught, counted, weight));
    }
    store(batch.scratch + i, bin_on(screen, x, z) | ~caught);
    store(batch.slowness + i, select((mask)caught, 1.0 / vy, load(batch.slowness + i)));
    store(batch.caught_by + i,
          select((mask)caught, broadcast_word(static_cast<unsigned long long>(screen.part + 1)),
                 load(batch.caught_by + i)));
    store(batch.flying + i, flying & ~hit);
    counted_weight = counted_weight + (counted & caught);
    lost_weight = lost_weight + (weight & hit) - (counted & caught);
  }
  return {sum(counted_weight), sum(lost_weight)};
}

void align(const Alignment& alignment, const RandomKey& key, BatchView& batch) {
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real sign = drawn_sign(alignment, key, load(batch.particle + i));
    const mask flying = (mask)load(batch.flying + i);
    const real zero = broadcast(0);
    store(batch.sx + i, select(flying, zero, load(batch.sx + i)));
    store(batch.sy + i, select(flying, zero, load(batch.sy + i)));
    if (alignment.levels > 0) {
      const words bottom = broadcast_word(static_cast<unsigned long long>(alignment.levels - 1));
      store(batch.level + i, select(flying, select(sign > zero, words{}, bottom), load(batch.level + i)));
      store(batch.sz + i, select(flying, broadcast(1), load(batch.sz + i)));
    } else {
      store(batch.sz + i, select(flying, sign, load(batch.sz + i)));
    }
  }
}

}  // namespace rabiline::RABILINE_ISA
