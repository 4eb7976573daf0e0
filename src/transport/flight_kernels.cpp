// Straight flight: drifts, openings, screens, alignment.
#include "transport/kernel_functions.hpp"
#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

std::uint64_t sum(words w) {
  std::uint64_t total = 0;
  for (int k = 0; k < lane_count; ++k) total += lane(w, k);
  return total;
}

}  // namespace

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
    const Vector spin = aligned_spin(alignment, sign);
    store(batch.sx + i, select(flying, spin.x, load(batch.sx + i)));
    store(batch.sy + i, select(flying, spin.y, load(batch.sy + i)));
    store(batch.sz + i, select(flying, spin.z, load(batch.sz + i)));
    if (alignment.levels == 0) continue;
    const words bottom = broadcast_word(static_cast<unsigned long long>(alignment.levels - 1));
    const words level = select(flying, select(sign > broadcast(0), words{}, bottom), load(batch.level + i));
    store(batch.level + i, level);
    store(batch.prepared + i, select(flying, level, load(batch.prepared + i)));
  }
}

}  // namespace rabiline::RABILINE_ISA
