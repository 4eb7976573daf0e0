#pragma once
// Steps of levels whose phases alone turn, for kernels only.
#include "transport/level_jump_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// Of the tolerance, for one change between dressed and bare states: in many levels they add up.
inline constexpr double calm_share = 0.01;

/// By how much the rates at which a field turns change over a step of the length h, from point to point.
class TurningRates {
 public:
  TurningRates(const FollowedField& begin, real h) : h_(h), last_{begin.turn_1, begin.turn_2} {}
  /// What the dressed states leave out there, in units of the gap: the product of the rate and of its first
  /// derivative, and the second, which is large where the rate is not. The factors are on the safe side of
  /// what random fields were found to need.
  real left_out(const FollowedField& f, double share, real gap) {
    const double apart = share - share_, between = 0.5 * (apart + apart_);
    const real now[2] = {f.turn_1, f.turn_2}, over = 1.0 / gap, per = over / (apart * h_),
               bent = over / (between * h_), stretching = f.size_rate / max(f.size, broadcast(tiny));
    real rate2 = stretching * stretching, slope2 = broadcast(0), bend2 = broadcast(0);
    for (int k = 0; k < 2; ++k) {
      const real slope = (now[k] - last_[k]) * per, bend = (slope - slope_[k]) * bent;
      rate2 = fma(now[k], now[k], rate2);
      slope2 = fma(slope, slope, slope2);
      bend2 = fma(bend, bend, bend2);
      last_[k] = now[k];
      slope_[k] = slope;
    }
    const bool is_first = share_ == 0;
    share_ = share;
    apart_ = apart;
    const real product = 3.0 * sqrt(rate2 * slope2) * (over * over), third = sqrt(bend2) * over,
               swift = sqrt(rate2) * h_;
    return select(swift < broadcast(1.5), is_first ? product : max(product, 0.2 * third), broadcast(1));
  }

 private:
  real h_, last_[2], slope_[2]{};
  double share_ = 0, apart_ = 0;
};

/// Phases over a long step, by Kronrod's seven points; the error is that of QUADPACK, by what Gauss' three
/// differ: 200^(3/2) times its power 3/2, over the root of the variation.
/// at(s, &h) is the field at the time s, in a frame that begins with the axes, and H there.
template <class At>
[[gnu::noinline]] inline mask turn_phases(const LevelManifold& manifold, double tolerance, const At& at,
                                          real s, real h, const FollowedField& here, const LevelAxes& axes,
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
  const double left_out = 2 * calm_share * tolerance;
  TurningRates rates(here, h);
  real gap{};
  for (int i = 0; i < 7; ++i) {
    LevelMatrix now;
    const FollowedField f = at(s + (0.5 + 0.5 * place[i]) * h, &now);
    const Calm calm = calm_of(manifold, now);
    gap = max(calm.gap, broadcast(tiny));
    good = good & (f.cosine > broadcast(0.5)) & (f.signed_size * here.signed_size > broadcast(0)) &
           (calm.left_out(broadcast(0)) < broadcast(left_out)) &
           (rates.left_out(f, 0.5 + 0.5 * place[i], gap) < broadcast(left_out));
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
  good = good & (end.cosine > broadcast(0.5)) & (rates.left_out(end, 1, gap) < broadcast(left_out));
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
