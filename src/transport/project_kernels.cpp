// Spins through the fields of a straight flight, and the levels that a detector finds. Moves nobody.
#include "transport/outcome_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

/// Sums over lanes until the end of the batch, exact in floating point: q^2 <= 2^80 is a multiple of 2^40
/// plus a rest of at most 2^39 either way.
struct Accumulator {
  static_assert(Batch::capacity <= 4096, "the sum of q^2 / 2^40 has at most 53 bits");
  real q = real{}, multiple = real{}, rest = real{};
  RABILINE_LANES void add_product(real a, real b) {
    constexpr double shift = 0x1.8p92;  // the last bit of a number near it is 2^40
    const real nearest = fma(a, b, broadcast(shift)) - shift;
    multiple = multiple + nearest;
    rest = rest + fma(a, b, -nearest);
  }
  RABILINE_LANES void add(real quanta) {
    q = q + quanta;
    add_product(quanta, quanta);
  }
  void flush(LevelSums& sums, int level) const {
    for (int k = 0; k < lane_count; ++k) {
      sums.q[level] += static_cast<std::uint64_t>(lane(q, k));
      sums.squares_high[level] += static_cast<std::uint64_t>(lane(multiple, k) * 0x1p-40);
      sums.squares_low[level] += static_cast<std::int64_t>(lane(rest, k));
    }
  }
  void flush_products(LevelSums& sums, int level) const {
    for (int k = 0; k < lane_count; ++k) {
      sums.products_high[level] += static_cast<std::uint64_t>(lane(multiple, k) * 0x1p-40);
      sums.products_low[level] += static_cast<std::int64_t>(lane(rest, k));
    }
  }
};

/// The weight of what the detector caught, up to 2^40; zero elsewhere.
RABILINE_LANES real caught_weight(const Projection& p, const BatchView& batch, int i) {
  const mask caught =
      load(batch.caught_by + i) == broadcast_word(static_cast<unsigned long long>(p.part + 1));
  return number_of(load(batch.weight + i) & (words)caught);
}

/// Slowness of what the detector caught [s/m]; of everything else, whose column may hold anything, one that
/// is harmless.
RABILINE_LANES real caught_slowness(const BatchView& batch, int i, real weight) {
  return select(weight > broadcast(0), load(batch.slowness + i), broadcast(1e-6));
}

/// Two levels: m = +1/2 and -1/2, or (1 + S_z)/2 and (1 - S_z)/2 of a vector law.
real upper_fraction(const Projection& p, const BatchView& batch, int i, real flip_or_sz) {
  if (!p.majorana) return fma(flip_or_sz, broadcast(0.5), broadcast(0.5));
  return select(load(batch.level + i) == words{}, 1.0 - flip_or_sz, flip_or_sz);
}

void project_two(const Projection& p, const BatchView& batch, LevelSums& sums) {
  Accumulator upper, lower;
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real weight = caught_weight(p, batch, i);
    const real sz =
        spin_after(p.path.zones, p.path.zone_count, p.path.key, batch, i, caught_slowness(batch, i, weight))
            .z;
    const real up = upper_fraction(p, batch, i, p.majorana ? flip_probability(sz) : sz);
    const Shares shares = share(weight, max(broadcast(0), min(broadcast(1), up)));
    upper.add(shares.first);
    lower.add(shares.second);
  }
  upper.flush(sums, 0);
  lower.flush(sums, 1);
}

/// From a level through one rotating field.
void project_two_through_one_zone(const Projection& p, const BatchView& batch, LevelSums& sums) {
  const RabiFlop flop(p.path.zones[0]);
  // Two short loops: a processor holds several rounds of each at a time.
  alignas(64) double flips[Batch::capacity];
  for (int i = 0; i < batch.padded; i += lane_count)
    store(flips + i, flop.probability(load(batch.slowness + i)));
  Accumulator upper, lower;
  for (int i = 0; i < batch.padded; i += lane_count) {
    const Shares shares = share(caught_weight(p, batch, i), upper_fraction(p, batch, i, load(flips + i)));
    upper.add(shares.first);
    lower.add(shares.second);
  }
  upper.flush(sums, 0);
  lower.flush(sums, 1);
}

/// More than two levels: all shares are floored, the largest takes what is missing.
void project_many(const Projection& p, const BatchView& batch, LevelSums& sums) {
  Accumulator levels[most_levels], products[most_levels];
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real weight = caught_weight(p, batch, i);
    const real flip =
        max(broadcast(0),
            min(broadcast(1), flip_probability(spin_after(p.path.zones, p.path.zone_count, p.path.key, batch,
                                                          i, caught_slowness(batch, i, weight))
                                                   .z)));
    real quanta[most_levels];
    for (int to = 0; to < p.path.levels; ++to)
      quanta[to] = floor(
          weight * outcome_probability(p.path.polynomials, p.path.levels, load(batch.level + i), to, flip));
    give_rest_to_largest(quanta, p.path.levels, weight);
    for (int to = 0; to < p.path.levels; ++to) {
      levels[to].add(quanta[to]);
      products[to].add_product(quanta[to], weight);
    }
  }
  for (int to = 0; to < p.path.levels; ++to) {
    levels[to].flush(sums, to);
    products[to].flush_products(sums, to);
  }
}

/// Calls f with the first particle of each vector of lanes some of which a path has counted.
template <class F>
RABILINE_LANES void each_lanes_counted(const ShareCount& c, int path, const F& f) {
  for (std::size_t k = c.first_eight[path]; k < c.first_eight[path + 1]; ++k)
    for (int i = 8 * c.eights[k]; i < 8 * c.eights[k] + 8; i += lane_count) f(i);
}

}  // namespace

void count_shares(const ShareCount& c, std::uint64_t* counts, std::uint64_t* totals, LevelSums& sums) {
  for (int i = 0; i < c.padded; i += lane_count) store(totals + i, words{});
  for (int path = 0; path < c.paths; ++path) {
    Accumulator sum;
    const std::uint64_t* shares = c.shares + c.levels[path] * c.padded;
    each_lanes_counted(c, path, [&](int i) {
      real q = number_of(load(shares + i) & load(c.hits + path * c.padded + i));
      if (c.efficiency != 1) q = floor(q * c.efficiency);
      sum.add(q);
      const words counted = weight_of(q);
      store(counts + path * c.padded + i, counted);
      store(totals + i, load(totals + i) + counted);
    });
    sum.flush(sums, path);
  }
  Accumulator all;
  for (int i = 0; i < c.padded; i += lane_count) all.add(number_of(load(totals + i)));
  all.flush(sums, c.paths);
  for (int path = 0; path < c.paths; ++path) {
    Accumulator products;
    each_lanes_counted(c, path, [&](int i) {
      products.add_product(number_of(load(counts + path * c.padded + i)), number_of(load(totals + i)));
    });
    products.flush_products(sums, path);
  }
}

void project(const Projection& p, const BatchView& batch, LevelSums& sums) {
  if (p.path.levels > 2)
    project_many(p, batch, sums);
  else if (p.path.from_level && p.path.zone_count == 1 && has_closed_form(p.path.zones[0]))
    project_two_through_one_zone(p, batch, sums);
  else
    project_two(p, batch, sums);
}

}  // namespace rabiline::RABILINE_ISA
