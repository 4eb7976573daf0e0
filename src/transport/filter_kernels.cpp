// Spins in the middle of a straight flight: carried through fields, and filtered.
#include "transport/kernel_functions.hpp"
#include "transport/spin_lanes.hpp"

namespace rabiline::RABILINE_ISA {

void precess(const SpinZone* zones, int zone_count, const RandomKey& key, BatchView& batch) {
  for (int i = 0; i < batch.padded; i += lane_count) {
    const mask flying = (mask)load(batch.flying + i);
    const Vector s = spin_after(zones, zone_count, key, batch, i, 1.0 / load(batch.vy + i));
    store(batch.sx + i, select(flying, s.x, load(batch.sx + i)));
    store(batch.sy + i, select(flying, s.y, load(batch.sy + i)));
    store(batch.sz + i, select(flying, s.z, load(batch.sz + i)));
  }
}

/// A pure state of spin 1/2 with Bloch vector s passes diag(sqrt(up), sqrt(down)) along the axis a: with c =
/// s.a it is transmitted with w = (up (1 + c) + down (1 - c))/2, and leaves with the Bloch vector
/// [(up (1 + c) - down (1 - c))/2 a + sqrt(up down) (s - c a)] / w.
std::uint64_t filter(const Filter& f, BatchView& batch) {
  const Vector axis{broadcast(f.axis[0]), broadcast(f.axis[1]), broadcast(f.axis[2])};
  const double coherence = __builtin_sqrt(f.up * f.down);
  std::uint64_t stopped = 0;
  words lost = words{};
  for (int i = 0; i < batch.padded; i += lane_count) {
    const mask flying = (mask)load(batch.flying + i);
    const real sign =
        select(f.quantum ? load(batch.level + i) != words{} : mask{}, broadcast(-1), broadcast(1));
    const Vector s{sign * load(batch.sx + i), sign * load(batch.sy + i), sign * load(batch.sz + i)};
    const real c = max(broadcast(-1), min(broadcast(1), dot(s, axis)));
    const real up = f.up * (0.5 * (1.0 + c)), down = f.down * (0.5 * (1.0 - c));
    const real passed = min(broadcast(1), up + down);
    const Vector across = add(s, -c, axis);
    const real along = up - down;
    Vector out{fma(along, axis.x, coherence * across.x), fma(along, axis.y, coherence * across.y),
               fma(along, axis.z, coherence * across.z)};
    const real size = sqrt(dot(out, out));
    const mask changes = flying & (size > broadcast(0));
    const real scale = sign / select(changes, size, broadcast(1));
    out = {out.x * scale, out.y * scale, out.z * scale};
    store(batch.sx + i, select(changes, out.x, load(batch.sx + i)));
    store(batch.sy + i, select(changes, out.y, load(batch.sy + i)));
    store(batch.sz + i, select(changes, out.z, load(batch.sz + i)));
    const words weight = load(batch.weight + i);
    const real quanta = from_bits(weight | 0x4330000000000000ULL) - 0x1p52;
    const words kept = bit_pattern(floor(quanta * passed) + 0x1p52) & 0xfffffffffffffULL;
    store(batch.weight + i, select(flying, kept, weight));
    store(batch.flying + i, (words)(flying & (kept != words{})));
    lost = lost + ((weight - kept) & (words)flying);
  }
  for (int k = 0; k < lane_count; ++k) stopped += lane(lost, k);
  return stopped;
}

}  // namespace rabiline::RABILINE_ISA
