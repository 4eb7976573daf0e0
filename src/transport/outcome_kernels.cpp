// In which level along the field a state is found: shared out among all levels, or drawn.
#include "transport/outcome_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

/// The probability that a state's image of z is flipped.
class Flip {
 public:
  explicit Flip(const SpinPathView& q)
      : q_(q), closed_(q.from_level && q.zone_count == 1 && has_closed_form(q.zones[0])) {
    if (closed_) flop_ = RabiFlop(q.zones[0]);
  }
  RABILINE_LANES real probability(const BatchView& batch, int i, real slowness) const {
    if (closed_) return flop_.probability(slowness);
    const real flip = flip_probability(spin_after(q_.zones, q_.zone_count, q_.key, batch, i, slowness).z);
    return max(broadcast(0), min(broadcast(1), flip));
  }

 private:
  const SpinPathView& q_;
  const bool closed_;
  RabiFlop flop_;
};

void share_by_flip(const SpinPathView& q, const BatchView& batch, const std::uint64_t* weights,
                   std::uint64_t* shares) {
  const Flip flip(q);
  for (int i = 0; i < batch.padded; i += lane_count) {
    const words weight_words = load(weights + i);
    const mask counted = weight_words != words{};
    if (!any(counted)) {
      for (int to = 0; to < q.levels; ++to) store(shares + to * batch.padded + i, words{});
      continue;
    }
    const real weight = number_of(weight_words);
    // What does not count stays for no time, however it flies.
    const real slowness = select(counted, 1.0 / load(batch.vy + i), broadcast(0));
    const real p = flip.probability(batch, i, slowness);
    const words from = load(batch.level + i);
    if (q.levels == 2) {
      const Shares two = share(weight, select(from == words{}, 1.0 - p, p));
      store(shares + i, weight_of(two.first));
      store(shares + batch.padded + i, weight_of(two.second));
      continue;
    }
    real parts[most_levels];
    for (int to = 0; to < q.levels; ++to) parts[to] = broadcast(0);
    for (int start = 0; start < q.levels; ++start) {
      const mask here = from == broadcast_word(static_cast<unsigned long long>(start));
      if (!any(here)) continue;
      for (int to = 0; to < q.levels; ++to)
        parts[to] = select(here, floor(weight * majorana(q.polynomials, q.levels, start, to, p)), parts[to]);
    }
    give_rest_to_largest(parts, q.levels, weight);
    for (int to = 0; to < q.levels; ++to) store(shares + to * batch.padded + i, weight_of(parts[to]));
  }
}

/// Four neighbouring points of a table and their weights (Lagrange).
struct Stencil {
  int point;
  double weight[4];
};
Stencil stencil_at(const Transitions& t, double slowness) {
  if (t.points == 1) return {0, {1, 0, 0, 0}};
  const double last = t.points - 1;
  double at = (slowness - t.first) * t.points_per_slowness;
  at = at < 0 ? 0 : at > last ? last : at;
  int point = static_cast<int>(at) - 1;
  point = point < 0 ? 0 : point > t.points - 4 ? t.points - 4 : point;
  const double u = at - point, a = u - 1, b = u - 2, c = u - 3;
  return {point, {-a * b * c / 6, u * b * c / 2, -u * a * c / 2, u * a * b / 6}};
}

/// One particle after the other, all levels it may go to at once.
void share_by_table(const SpinPathView& q, const BatchView& batch, const std::uint64_t* weights,
                    std::uint64_t* shares) {
  const Transitions& t = q.transitions;
  for (int i = 0; i < q.levels * batch.padded; i += lane_count) store(shares + i, words{});
  for (int i = 0; i < batch.padded; ++i) {
    if (weights[i] == 0) continue;
    const Stencil s = stencil_at(t, 1 / batch.vy[i]);
    const int begin = t.begin[batch.level[i]], end = t.begin[batch.level[i] + 1];
    const float* base = t.values + static_cast<std::int64_t>(s.point) * t.row;
    const double weight = static_cast<double>(weights[i]);
    std::uint64_t rest = weights[i], largest = 0;
    int largest_level = static_cast<int>(batch.level[i]);
    for (int target = begin; target < end; target += lane_count) {
      real p = broadcast(s.weight[0]) * load(base + target);
      if (t.points > 1)
        for (int k = 1; k < 4; ++k) p = fma(broadcast(s.weight[k]), load(base + k * t.row + target), p);
      const words part = weight_of(floor(weight * max(broadcast(0), min(broadcast(1), p))));
      for (int k = 0; k < lane_count && target + k < end; ++k) {
        // Interpolated shares may add up to more than all by rounding.
        const std::uint64_t share = lane(part, k) < rest ? lane(part, k) : rest;
        const int to = t.targets[target + k];
        shares[to * batch.padded + i] = share;
        rest -= share;
        if (share > largest) {
          largest = share;
          largest_level = to;
        }
      }
    }
    shares[largest_level * batch.padded + i] += rest;
  }
}

}  // namespace

void outcomes(const SpinPathView& q, const BatchView& batch, const std::uint64_t* weights,
              std::uint64_t* shares) {
  if (q.transitions.values != nullptr)
    share_by_table(q, batch, weights, shares);
  else
    share_by_flip(q, batch, weights, shares);
}

void collapse(const SpinPathView& q, int part, BatchView& batch) {
  alignas(64) std::uint64_t whole[Batch::capacity], shares[most_levels * Batch::capacity];
  for (int i = 0; i < batch.padded; i += lane_count)
    store(whole + i, load(batch.flying + i) & broadcast_word(quanta_per_particle));
  outcomes(q, batch, whole, shares);
  for (int i = 0; i < batch.padded; i += lane_count) {
    const mask flying = (mask)load(batch.flying + i);
    real u, unused;
    uniforms(load(batch.particle + i), q.key.seed, purpose::collapse, static_cast<unsigned>(part),
             q.key.stream, u, unused);
    const real drawn = u * static_cast<double>(quanta_per_particle);
    words level = words{}, below = words{};
    for (int to = 0; to + 1 < q.levels; ++to) {
      below = below + load(shares + to * batch.padded + i);
      level = level + ((words)(drawn >= number_of(below)) & broadcast_word(1));
    }
    store(batch.level + i, select(flying, level, load(batch.level + i)));
    store(batch.sx + i, select(flying, broadcast(0), load(batch.sx + i)));
    store(batch.sy + i, select(flying, broadcast(0), load(batch.sy + i)));
    store(batch.sz + i, select(flying, broadcast(1), load(batch.sz + i)));
  }
}

}  // namespace rabiline::RABILINE_ISA
