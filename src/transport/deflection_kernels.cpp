// The paths of particles in deflecting magnets.
#include "transport/kernel_functions.hpp"
#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

/// Whether a coordinate stays between walls on q + v t + a t^2/2 for 0 <= t <= T: at the end, and where it
/// turns round.
RABILINE_LANES mask stays_between(real q, real v, real a, real end_time, double centre, double half) {
  const auto inside = [&](real t) { return abs(fma(fma(0.5 * a, t, v), t, q - centre)) <= broadcast(half); };
  const real turn = select(a != broadcast(0), -v / a, broadcast(-1));
  const mask turns = (turn > broadcast(0)) & (turn < end_time);
  return inside(end_time) & (inside(turn) | ~turns);
}

}  // namespace

std::uint64_t deflect(const Deflection& d, BatchView& batch) {
  words stopped = words{};
  const double way = d.end - batch.y;
  for (int i = 0; i < batch.padded; i += lane_count) {
    const words flying = load(batch.flying + i);
    const real vy = load(batch.vy + i), dt = broadcast(way) / vy;
    // The part of the moment along z: m/I of a level, S_z of a vector.
    const real part =
        d.levels > 0 ? fma(number_of(load(batch.level + i)), broadcast(-2.0 / (d.levels - 1)), broadcast(1))
                     : load(batch.sz + i);
    const real a = select((mask)flying, part * d.acceleration, broadcast(0));
    const real ax = a * d.along_x, az = a * d.along_z;
    const real x = load(batch.x + i), z = load(batch.z + i), vx = load(batch.vx + i), vz = load(batch.vz + i);
    if (d.has_gap) {
      const mask free =
          stays_between(x, vx, ax, dt, d.x0, d.half_x) & stays_between(z, vz, az, dt, d.z0, d.half_z);
      stopped = stopped + (load(batch.weight + i) & flying & ~(words)free);
      store(batch.flying + i, flying & (words)free);
    }
    store(batch.x + i, fma(fma(0.5 * ax, dt, vx), dt, x));
    store(batch.z + i, fma(fma(0.5 * az, dt, vz), dt, z));
    store(batch.vx + i, fma(ax, dt, vx));
    store(batch.vz + i, fma(az, dt, vz));
    store(batch.t + i, load(batch.t + i) + dt);
  }
  batch.y = d.end;
  std::uint64_t total = 0;
  for (int k = 0; k < lane_count; ++k) total += lane(stopped, k);
  return total;
}

}  // namespace rabiline::RABILINE_ISA
