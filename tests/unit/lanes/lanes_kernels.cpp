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
                                        .uniforms = uniform_columns};

}  // namespace rabiline::RABILINE_ISA
