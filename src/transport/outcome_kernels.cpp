// In which level along the field a state is found: shared out among all levels, or drawn.
#include <cstring>

#include "transport/level_lanes.hpp"
#include "transport/outcome_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

/// The probability that the image of the level that a state was in is flipped against the axis asked for.
class Flip {
 public:
  explicit Flip(const SpinPathView& q)
      : q_(q), closed_(q.from_level && q.zone_count == 1 && has_closed_form(q.zones[0])) {
    if (closed_) flop_ = RabiFlop(q.zones[0]);
    axis_ = {broadcast(q.axis[0]), broadcast(q.axis[1]), broadcast(q.axis[2])};
  }
  RABILINE_LANES real probability(const BatchView& batch, int i, real slowness) const {
    if (closed_) return flop_.probability(slowness);
    const Vector s = spin_after(q_.zones, q_.zone_count, q_.key, batch, i, slowness);
    const real flip = flip_probability(dot(axis_, s));
    return max(broadcast(0), min(broadcast(1), flip));
  }

 private:
  const SpinPathView& q_;
  const bool closed_;
  RabiFlop flop_;
  Vector axis_;
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
    const real slowness = select(counted, load(batch.slowness + i), broadcast(0));
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

/// Particles of a batch that count, in the order of their levels: from begin[level] to begin[level + 1].
class ByLevel {
 public:
  ByLevel(const BatchView& batch, const std::uint64_t* weights, int levels) {
    int count[most_levels] = {};
    each_run(batch, weights, [&](int from, int to, std::uint64_t level) { count[level] += to - from; });
    int next[most_levels];
    for (int level = 0; level < levels; ++level) {
      next[level] = begin[level];
      begin[level + 1] = begin[level] + count[level];
    }
    each_run(batch, weights, [&](int from, int to, std::uint64_t level) {
      for (int i = from; i < to; ++i) particles[next[level] + i - from] = i;
      next[level] += to - from;
    });
  }
  int particles[Batch::capacity];
  int begin[most_levels + 1] = {};

 private:
  /// Particles that stand side by side in one level.
  template <class F>
  static void each_run(const BatchView& batch, const std::uint64_t* weights, const F& f) {
    for (int from = 0, to = 0; from < batch.padded; from = to) {
      const std::uint64_t level = batch.level[from];
      for (; to < batch.padded && batch.level[to] == level && weights[to] != 0;) ++to;
      if (to > from)
        f(from, to, level);
      else
        ++to;
    }
  }
};

/// From the level at one place of a block to all of it: LevelBlock tells how.
/// `fixed`: how many levels it has, or 0 for any; where it is known, all of them stay in registers.
template <int fixed>
RABILINE_LANES void mix_levels(const LevelBlock& block, const double* numbers, int from, real slowness,
                               real* p) {
  constexpr double two_pi = 6.283185307179586;
  constexpr int most = fixed > 0 ? fixed : most_levels;
  const int n = fixed > 0 ? fixed : block.levels;
  real re[most], im[most], next_re[most], next_im[most];
  for (int to = 0; to < n; ++to) p[to] = broadcast(0);
  for (int sample = 0; sample < block.samples; ++sample) {
    const double* at = numbers;
    for (int k = 0; k < n; ++k) {
      re[k] = broadcast(at[k * n + from]);
      im[k] = broadcast(0);
    }
    at += n * n;
    for (int step = 0; step < block.steps; ++step) {
      const double* angles = at + n * (1 + sample);
      for (int k = 1; k < n; ++k) {
        const real cycles = fma(broadcast(at[k]), slowness, broadcast(angles[k]));
        real sine, cosine;
        sincos((cycles - round_to_nearest(cycles)) * two_pi, sine, cosine);
        const real turned = fma(re[k], cosine, im[k] * sine);
        im[k] = fnma(re[k], sine, im[k] * cosine);
        re[k] = turned;
      }
      at += n * (1 + block.samples);
      for (int to = 0; to < n; ++to, at += n) {
        real sum_re = re[0] * at[0], sum_im = im[0] * at[0];
        for (int k = 1; k < n; ++k) {
          sum_re = fma(re[k], broadcast(at[k]), sum_re);
          sum_im = fma(im[k], broadcast(at[k]), sum_im);
        }
        next_re[to] = sum_re;
        next_im[to] = sum_im;
      }
      for (int k = 0; k < n; ++k) {
        re[k] = next_re[k];
        im[k] = next_im[k];
      }
    }
    for (int to = 0; to < n; ++to) p[to] = fma(re[to], re[to], fma(im[to], im[to], p[to]));
  }
  for (int to = 0; to < n; ++to) p[to] = min(broadcast(1), p[to] * (1.0 / block.samples));
}
/// Whether particles in ascending order stand one behind the other, in whole lanes.
RABILINE_LANES bool stand_together(const int* particles, int lanes) {
  return lanes == lane_count && particles[lane_count - 1] - particles[0] == lane_count - 1;
}

/// The probability to end in the other one of two levels: LevelBlock tells how.
RABILINE_LANES real flip_of_two(const LevelBlock& block, const double* numbers, int from, real slowness) {
  constexpr double two_pi = 6.283185307179586;
  const double up = from == 0 ? 1 : -1;
  real stays = broadcast(0);
  for (int sample = 0; sample < block.samples; ++sample) {
    const double* at = numbers;
    real x = broadcast(up * at[2]), y = broadcast(0), z = broadcast(up * at[0]);
    at += 5;
    for (int step = 0; step < block.steps; ++step) {
      const real cycles = fma(broadcast(at[1]), slowness, broadcast(at[3 + 2 * sample]));
      real sine, cosine;
      sincos((cycles - round_to_nearest(cycles)) * two_pi, sine, cosine);
      at += 2 + 2 * block.samples;
      const real turned = fma(x, cosine, y * sine);
      y = fnma(x, sine, y * cosine) * at[4];
      x = fma(turned, broadcast(at[3]), z * at[2]);
      z = fma(turned, broadcast(at[1]), z * at[0]);
      at += 5;
    }
    stays = stays + z;
  }
  return max(broadcast(0),
             min(broadcast(1), fma(stays, broadcast(-0.5 * up / block.samples), broadcast(0.5))));
}

/// A weight in the level at one place of a block, shared between all of its levels.
template <int fixed>
RABILINE_LANES void share_out(const LevelBlock& block, const double* numbers, int from, real slowness,
                              real weight, real* parts) {
  if constexpr (fixed == 2) {
    const Shares two = share(weight, flip_of_two(block, numbers, from, slowness));
    parts[1 - from] = two.first;
    parts[from] = two.second;
  } else {
    const int levels = fixed > 0 ? fixed : block.levels;
    mix_levels<fixed>(block, numbers, from, slowness, parts);
    for (int to = 0; to < levels; ++to) parts[to] = floor(weight * parts[to]);
    give_rest_to_largest(parts, levels, weight);
  }
}

/// Particles that begin in that level, a vector of them at a time. `columns`: the shares of the block's
/// levels.
template <int fixed>
[[gnu::noinline]] void share_in_block(const LevelBlock& block, const double* numbers, int from,
                                      const int* particles, int count, const double* slownesses,
                                      const std::uint64_t* weights, std::uint64_t* const* columns) {
  const int levels = fixed > 0 ? fixed : block.levels;
  for (int begin = 0; begin < count; begin += lane_count) {
    const int* here = particles + begin;
    const int lanes = count - begin < lane_count ? count - begin : lane_count;
    const bool together = stand_together(here, lanes);
    words weight{};
    real slowness = broadcast(1), parts[fixed > 0 ? fixed : most_levels];
    if (together) {
      weight = load_anywhere(weights + here[0]);
      slowness = load_anywhere(slownesses + here[0]);
    } else
      for (int k = 0; k < lanes; ++k) {
        set_lane(weight, k, weights[here[k]]);
        set_lane(slowness, k, slownesses[here[k]]);
      }
    share_out<fixed>(block, numbers, from, slowness, number_of(weight), parts);
    for (int to = 0; to < levels; ++to) {
      const words part = weight_of(parts[to]);
      if (together)
        store_anywhere(columns[to] + here[0], part);
      else
        for (int k = 0; k < lanes; ++k) columns[to][here[k]] = lane(part, k);
    }
  }
}

void share_by_transitions(const SpinPathView& q, const BatchView& batch, const std::uint64_t* weights,
                          std::uint64_t* shares) {
  const Transitions& t = q.transitions;
  const int padded = batch.padded;
  std::memset(shares, 0, sizeof(std::uint64_t) * static_cast<std::size_t>(q.levels * padded));
  const ByLevel ordered(batch, weights, q.levels);
  for (int level = 0; level < q.levels; ++level) {
    const int* particles = ordered.particles + ordered.begin[level];
    const int count = ordered.begin[level + 1] - ordered.begin[level];
    if (t.block_of[level] < 0) {
      for (int i = 0; i < count; ++i) shares[level * padded + particles[i]] = weights[particles[i]];
      continue;
    }
    const LevelBlock& block = t.blocks[t.block_of[level]];
    const int* levels = t.levels + block.first_level;
    int from = 0;
    while (levels[from] != level) ++from;
    std::uint64_t* columns[most_levels];
    for (int to = 0; to < block.levels; ++to) columns[to] = shares + levels[to] * padded;
    const auto share_in = block.levels == 2   ? share_in_block<2>
                          : block.levels == 3 ? share_in_block<3>
                                              : share_in_block<0>;
    share_in(block, t.numbers + block.first_number, from, particles, count, batch.slowness, weights, columns);
  }
}

/// Particles that begin in one level, through fields of any direction. The number of one that is lost, or
/// no_particle.
std::uint64_t share_by_course(const SpinPathView& q, const BatchView& batch, const std::uint64_t* weights,
                              std::uint64_t* shares) {
  const LevelCourse& course = *q.course;
  std::uint64_t lost = no_particle;
  for (int i = 0; i < q.levels * batch.padded; i += lane_count) store(shares + i, words{});
  const ByLevel ordered(batch, weights, q.levels);
  for (int level = 0; level < q.levels; ++level) {
    const int* particles = ordered.particles + ordered.begin[level];
    const int count = ordered.begin[level + 1] - ordered.begin[level];
    const LevelManifold& manifold = course.manifolds[course.manifold_of[level]];
    if (manifold.couplings == 0) {
      for (int i = 0; i < count; ++i) shares[level * batch.padded + particles[i]] = weights[particles[i]];
      continue;
    }
    for (int begin = 0; begin < count; begin += lane_count) {
      words weight_words{}, number{};
      real t{}, parts[most_levels];
      Vector place{}, velocity{};
      for (int k = 0; k < lane_count; ++k) {
        const int i = particles[begin + k < count ? begin + k : begin];
        if (begin + k < count) set_lane(weight_words, k, weights[i]);
        set_lane(number, k, batch.particle[i]);
        set_lane(place.x, k, batch.x[i]);
        set_lane(place.z, k, batch.z[i]);
        set_lane(velocity.x, k, batch.vx[i]);
        set_lane(velocity.y, k, batch.vy[i]);
        set_lane(velocity.z, k, batch.vz[i]);
        set_lane(t, k, batch.t[i]);
      }
      LevelFlight flight(course, manifold, {course, q.key, batch.y, place, velocity, t, batch.fall, number});
      flight.fly(course.place_of[level], weight_words != words{});
      for (int k = 0; k < lane_count; ++k)
        if (lane((words)flight.lost(), k) != 0) lost = lane(number, k);
      flight.probabilities(parts, q.levels);
      const real weight = number_of(weight_words);
      for (int to = 0; to < q.levels; ++to) parts[to] = floor(weight * parts[to]);
      give_rest_to_largest(parts, q.levels, weight);
      for (int to = 0; to < q.levels; ++to) {
        const words part = weight_of(parts[to]);
        for (int k = 0; k < lane_count && begin + k < count; ++k)
          shares[to * batch.padded + particles[begin + k]] = lane(part, k);
      }
    }
  }
  return lost;
}

}  // namespace

std::uint64_t outcomes(const SpinPathView& q, const BatchView& batch, const std::uint64_t* weights,
                       std::uint64_t* shares) {
  if (q.course != nullptr) return share_by_course(q, batch, weights, shares);
  if (q.transitions.block_of != nullptr)
    share_by_transitions(q, batch, weights, shares);
  else
    share_by_flip(q, batch, weights, shares);
  return no_particle;
}

std::uint64_t collapse(const SpinPathView& q, int part, BatchView& batch) {
  alignas(64) std::uint64_t whole[Batch::capacity], shares[most_levels * Batch::capacity];
  for (int i = 0; i < batch.padded; i += lane_count)
    store(whole + i, load(batch.flying + i) & broadcast_word(quanta_per_particle));
  const std::uint64_t lost = outcomes(q, batch, whole, shares);
  batch.up = false;
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
    store(batch.sx + i, select(flying, broadcast(q.axis[0]), load(batch.sx + i)));
    store(batch.sy + i, select(flying, broadcast(q.axis[1]), load(batch.sy + i)));
    store(batch.sz + i, select(flying, broadcast(q.axis[2]), load(batch.sz + i)));
  }
  return lost;
}

}  // namespace rabiline::RABILINE_ISA
