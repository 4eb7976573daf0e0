#include "lanes_kernels.hpp"

#include "core/lanes.hpp"
#include "core/random_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

template <real (*f)(real)>
void unary(const Column& x, Column& y) {
  for (int i = 0; i < Column::length; i += lane_count) store(y.value + i, f(load(x.value + i)));
}
template <real (*f)(real, real)>
void binary(const Column& a, const Column& b, Column& y) {
  for (int i = 0; i < Column::length; i += lane_count)
    store(y.value + i, f(load(a.value + i), load(b.value + i)));
}
template <real (*f)(real, real, real)>
void ternary(const Column& a, const Column& b, const Column& c, Column& y) {
  for (int i = 0; i < Column::length; i += lane_count)
    store(y.value + i, f(load(a.value + i), load(b.value + i), load(c.value + i)));
}
template <void (*f)(real, real&, real&)>
void pair(const Column& x, Column& first, Column& second) {
  for (int i = 0; i < Column::length; i += lane_count) {
    real p, q;
    f(load(x.value + i), p, q);
    store(first.value + i, p);
    store(second.value + i, q);
  }
}

void choose(const Column& a, const Column& b, const Column& c, int n, Column& y) {
  for (int i = 0; i < Column::length; i += lane_count) {
    const real p = load(a.value + i), q = load(b.value + i);
    const real chosen = select((p < q) & ~(p < 0.0), load(c.value + i), p + q);
    store(y.value + i, select(first_lanes(n), -chosen, chosen));
  }
}

void count_below(const Column& x, double limit, int& count, bool& any_first, bool& all_first) {
  count = 0;
  for (int i = 0; i < Column::length; i += lane_count)
    count += __builtin_popcount(bits_of(load(x.value + i) < broadcast(limit)));
  const mask first = load(x.value) < broadcast(limit);
  any_first = any(first);
  all_first = all(first);
}

void uniform_columns(const WordColumn& particle, std::uint64_t seed, unsigned purpose, unsigned draw,
                     unsigned stream, Column& u0, Column& u1) {
  for (int i = 0; i < Column::length; i += lane_count) {
    real p, q;
    uniforms(load(particle.value + i), seed, purpose, draw, stream, p, q);
    store(u0.value + i, p);
    store(u1.value + i, q);
  }
}

void coarse_uniform_columns(const WordColumn& particle, std::uint64_t seed, unsigned purpose, unsigned draw,
                            unsigned stream, Column (&u)[4]) {
  for (int i = 0; i < Column::length; i += lane_count) {
    const RandomBlock block = random_block(load(particle.value + i), seed, purpose, draw, stream);
    store(u[0].value + i, coarse_uniform(block.c0));
    store(u[1].value + i, coarse_uniform(block.c1));
    store(u[2].value + i, coarse_uniform(block.c2));
    store(u[3].value + i, coarse_uniform(block.c3));
  }
}

void interleave_columns(const Column& a, const Column& b, Column& low, Column& high) {
  for (int i = 0; i < Column::length; i += lane_count) {
    real p, q;
    interleave(load(a.value + i), load(b.value + i), p, q);
    store(low.value + i, p);
    store(high.value + i, q);
  }
}

int pack_even(const WordColumn& x, WordColumn& y) {
  int count = 0;
  alignas(64) std::uint64_t packed[Column::length + lane_count];
  for (int i = 0; i < Column::length; i += lane_count)
    count += pack(load(x.value + i), (load(x.value + i) & 1ULL) == 0ULL, packed + count);
  for (int i = 0; i < count; ++i) y.value[i] = packed[i];
  return count;
}

}  // namespace

extern const LanesKernels lanes_kernels{.lane_count = lane_count,
                                        .sincos = pair<sincos>,
                                        .sin_squared = unary<sin_squared>,
                                        .log = unary<log>,
                                        .exp = unary<exp>,
                                        .atan = unary<atan>,
                                        .sqrt = unary<sqrt>,
                                        .abs = unary<abs>,
                                        .round_to_nearest = unary<round_to_nearest>,
                                        .rotation_coefficients = pair<rotation_coefficients>,
                                        .fma = ternary<fma>,
                                        .fnma = ternary<fnma>,
                                        .min = binary<min>,
                                        .max = binary<max>,
                                        .choose = choose,
                                        .count_below = count_below,
                                        .uniforms = uniform_columns,
                                        .coarse_uniforms = coarse_uniform_columns,
                                        .interleave = interleave_columns,
                                        .pack_even = pack_even};

}  // namespace rabiline::RABILINE_ISA
