#pragma once
// What becomes of amplitudes where the field is another one at once and the state stays, for kernels only.
#include "transport/level_exponential_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// The frame turns: the state turns back by -W . F of the levels at that size of the field.
[[gnu::noinline]] inline void turn_to(const LevelManifold& f, const Vector& n, real size, mask counted,
                                      LevelAxes& axes, Amplitudes& a) {
  const LevelAxes next = moved_to(n, axes);
  const Vector across = cross(axes.third, n);
  const real sine = length_of(across), cosine = dot(axes.third, n);
  const mask turns = counted & (sine > broadcast(1e-12));
  if (any(turns)) {
    // Half the angle from its tangent: it is at most 45 degrees.
    const real angle = 2.0 * atan(sine / (1.0 + cosine)), by = angle / select(turns, sine, broadcast(1));
    constexpr int parts = 8;
    FollowedField still{n, next.first, abs(size), size, broadcast(0), {}, {}, {}, broadcast(1)};
    still.turn_1 = select(turns, by * dot(across, axes.first), broadcast(0)) * (1.0 / parts);
    still.turn_2 = select(turns, by * dot(across, axes.second()), broadcast(0)) * (1.0 / parts);
    still.turn_3 = broadcast(0);
    LevelMatrix h;
    set_matrix(f, still, h);
    for (int k = 0; k < f.levels; ++k) h.diagonal[k] = broadcast(0);
    for (int i = 0; i < parts; ++i) {
      Amplitudes turned = a;
      exponentiate(f, h, turned);
      choose(f.levels, turns, turned, a);
    }
  }
  axes = {select(counted, next.third, axes.third), select(counted, next.first, axes.first)};
}

/// The field along the third axis gets another size.
[[gnu::noinline]] inline void resize(const LevelManifold& f, const LevelAxes& axes, real from, real to,
                                     mask counted, Amplitudes& a) {
  if (f.couplings == f.ladders) return;
  constexpr int parts = 8;
  const real each = (to - from) * (1.0 / parts);
  Amplitudes resized = a;
  for (int i = 0; i < parts; ++i) {
    const auto at = [&](double share, LevelMatrix& h) {
      const real b = fma(broadcast(i + share), each, from), zero = broadcast(0);
      set_matrix(f, {axes.third, axes.first, abs(b), b, each, zero, zero, zero, broadcast(1)}, h);
      for (int k = 0; k < f.levels; ++k) h.diagonal[k] = zero;
    };
    LevelMatrix points[5], h;
    for (int p = 0; p < 5; ++p) at(0.5 + 0.5 * lobatto_point[p], points[p]);
    to_legendre(f, broadcast(1), points);
    for (const auto& share : whole_step) {
      sum_up(f, points, share, h);
      exponentiate(f, h, resized);
    }
  }
  choose(f.levels, counted, resized, a);
}

}  // namespace rabiline::RABILINE_ISA
