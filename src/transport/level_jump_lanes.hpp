#pragma once
// What becomes of amplitudes in no field, and where the field is another one at once and the state stays, for
// kernels only.
#include "transport/level_step_lanes.hpp"

namespace rabiline::RABILINE_ISA {

RABILINE_LANES mask differ(const Vector& a, const Vector& b) {
  const Vector d = add(a, broadcast(-1), b);
  return dot(d, d) > broadcast(0);
}

/// In no field levels have the energies of their F.
[[gnu::noinline]] inline void rest(const LevelManifold& f, real stay, Amplitudes& a) {
  real energy[most_row];
  look_up(f, f.levels, broadcast(0), energy);
  for (int k = 0; k < f.levels; ++k) turn_back(energy[k] * stay, k, a);
}

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

/// The field along the third axis gets another size, in equal parts of theta.
[[gnu::noinline]] inline void resize(const LevelManifold& f, const LevelAxes& axes, real from, real to,
                                     int parts, Amplitudes& a) {
  const real begin = atan(from * (1 / f.scale)), each = (atan(to * (1 / f.scale)) - begin) * (1.0 / parts),
             zero = broadcast(0);
  for (int i = 0; i < parts; ++i) {
    const auto at = [&](double share, LevelMatrix& h) {
      real sine, cosine;
      sincos(fma(broadcast(i + share), each, begin), sine, cosine);
      const real b = f.scale * (sine / cosine), rate = f.scale * (each / (cosine * cosine));
      set_matrix(f, {axes.third, axes.first, abs(b), b, rate, zero, zero, zero, broadcast(1)}, h);
      for (int k = 0; k < f.levels; ++k) h.diagonal[k] = zero;
    };
    LevelMatrix points[5], h;
    for (int p = 0; p < 5; ++p) at(0.5 + 0.5 * lobatto_point[p], points[p]);
    to_legendre(f, broadcast(1), points);
    for (const auto& share : fourth_order) {
      sum_up(f, points, share, h);
      exponentiate(f, h, a);
    }
  }
}
/// The same in as many parts as keep the tolerance: where levels come close to one another they are many.
[[gnu::noinline]] inline void resize(const LevelManifold& f, const LevelAxes& axes, real from, real to,
                                     double tolerance, mask counted, Amplitudes& a) {
  if (f.couplings == f.ladders) return;
  constexpr int most_parts = 1 << 12;
  Amplitudes resized = a;
  resize(f, axes, from, to, 4, resized);
  mask open = counted;
  for (int parts = 8; parts <= most_parts && any(open); parts *= 2) {
    Amplitudes finer = a;
    resize(f, axes, from, to, parts, finer);
    const real off = difference(f.levels, resized, finer) * (1.0 / 15);
    choose(f.levels, open, finer, resized);
    open = open & (off > broadcast(0.1 * tolerance));
  }
  choose(f.levels, counted, resized, a);
}

}  // namespace rabiline::RABILINE_ISA
