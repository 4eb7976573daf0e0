#pragma once
// Steps of levels whose phases alone turn, for kernels only.
#include "transport/level_jump_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// Of the tolerance, for one change between dressed and bare states: in many levels they add up.
inline constexpr double calm_share = 0.01;

/// Phases over a long step, by Kronrod's seven points; the error is that of QUADPACK, by what Gauss' three
/// differ: 200^(3/2) times its power 3/2, over the root of the variation.
/// at(s, &h) is the field at the time s, in a frame that begins with the axes, and H there.
template <class At>
[[gnu::noinline]] inline mask turn_phases(const LevelManifold& manifold, double tolerance, const At& at,
                                          real s, real h, real size, const LevelAxes& axes,
                                          const Amplitudes& before, Amplitudes& turned, LevelAxes& there,
                                          real& error) {
  constexpr double place[7] = {-0.9604912687080202, -0.7745966692414834, -0.4342437493468026, 0,
                               0.4342437493468026,  0.7745966692414834,  0.9604912687080202};
  constexpr double kronrod[7] = {0.1046562260264673, 0.2684880898683334, 0.4013974147759622,
                                 0.4509165386584741, 0.4013974147759622, 0.2684880898683334,
                                 0.1046562260264673};
  constexpr double gauss[7] = {0, 5.0 / 9, 0, 8.0 / 9, 0, 5.0 / 9, 0};
  real angle[most_levels], off[most_levels], begun[most_levels], varies = broadcast(tiny);
  for (int k = 0; k < manifold.levels; ++k) angle[k] = off[k] = broadcast(0);
  mask good = ~mask{};
  real last_1{}, last_2{};
  for (int i = 0; i < 7; ++i) {
    LevelMatrix now;
    const FollowedField f = at(s + (0.5 + 0.5 * place[i]) * h, &now);
    const Calm calm = calm_of(manifold, now);
    const real turning2 = fma(f.turn_1, f.turn_1, f.turn_2 * f.turn_2),
               stretching = f.size_rate / max(f.size, broadcast(tiny));
    const real swift = sqrt(fma(stretching, stretching, turning2)),
               changes = swift / max(calm.gap, broadcast(tiny));
    const real ratio_1 = f.turn_1 / max(calm.gap, broadcast(tiny)),
               ratio_2 = f.turn_2 / max(calm.gap, broadcast(tiny));
    real moves = broadcast(0);
    if (i > 0) {
      const real dt = (0.5 * (place[i] - place[i - 1])) * h, d1 = ratio_1 - last_1, d2 = ratio_2 - last_2;
      moves = sqrt(fma(d1, d1, d2 * d2)) / (dt * max(calm.gap, broadcast(tiny)));
    }
    last_1 = ratio_1;
    last_2 = ratio_2;
    good = good & (f.cosine > broadcast(0.5)) & (f.signed_size * size > broadcast(0)) &
           (swift * h < broadcast(1.5)) &
           (max(calm.left_out(broadcast(0)), 3.0 * moves * changes) < broadcast(2 * calm_share * tolerance));
    real energy[most_levels];
    shifted_energies(manifold, now, energy);
    for (int k = 0; k < manifold.levels; ++k) {
      const real part = 0.5 * h * energy[k];
      if (i == 0) begun[k] = part;
      varies = max(varies, abs(part - begun[k]));
      angle[k] = fma(part, broadcast(kronrod[i]), angle[k]);
      off[k] = fma(part, broadcast(kronrod[i] - gauss[i]), off[k]);
    }
  }
  const FollowedField end = at(s + h, nullptr);
  good = good & (end.cosine > broadcast(0.5));
  there = moved_to(end.n, axes);
  // What is common to all levels that are there does not matter.
  real mean = broadcast(0), square = broadcast(0);
  for (int k = 0; k < manifold.levels; ++k) {
    const real share = fma(before.re[k], before.re[k], before.im[k] * before.im[k]);
    mean = fma(share, off[k], mean);
  }
  for (int k = 0; k < manifold.levels; ++k) {
    const real share = fma(before.re[k], before.re[k], before.im[k] * before.im[k]), d = off[k] - mean;
    square = fma(share * d, d, square);
    real sine, cosine;
    sincos(max(broadcast(-1e9), min(broadcast(1e9), angle[k])), sine, cosine);
    turned.re[k] = fma(before.re[k], cosine, before.im[k] * sine);
    turned.im[k] = fnma(before.re[k], sine, before.im[k] * cosine);
  }
  const real rms = sqrt(square);
  error = 2828.0 * rms * sqrt(rms / max(varies, rms));
  return good;
}

}  // namespace rabiline::RABILINE_ISA
