#pragma once
// Levels in fields that have a period, by the modes of LevelPeriod, for kernels only.
#include "transport/level_jump_lanes.hpp"
#include "transport/level_wave_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// Axes that the levels of modes lie along, from those of the amplitudes, in a static field of the signed
/// size `size` along their third, and by how much the first axes then still differ [rad], right-handed about
/// the third.
[[gnu::noinline]] inline real face_modes(const LevelManifold& f, const LevelPeriodForm& modes, real size,
                                         LevelAxes& axes, Amplitudes& a) {
  const auto axis_of = [](const double* v) {
    return Vector{broadcast(v[0]), broadcast(v[1]), broadcast(v[2])};
  };
  const Vector third = axis_of(modes.third), first = axis_of(modes.first);
  const mask back = dot(third, axes.third) < broadcast(0);
  turn_to(f, select(back, times(broadcast(-1), third), third), size, ~mask{}, axes, a);
  turn_over(f, back, a);
  axes.third = third;
  const real sine = dot(cross(third, first), axes.first), cosine = dot(first, axes.first),
             near = 2.0 * atan(sine / (1.0 + abs(cosine)));
  return select(cosine < broadcast(0), 3.141592653589793 - near, near);
}

/// Amplitudes from the time `begin` to `end` of the clock, where the angle of what drives is that of `phase`
/// at t = 0.
[[gnu::noinline]] inline void repeat_periods(const LevelManifold& f, const LevelPeriodForm& modes,
                                             double omega, real phase, real begin, real end, real apart,
                                             Amplitudes& a) {
  using Term = LevelPeriod::Term;
  const auto turn = [&](real t, double sign) {
    for (int k = 0; k < f.levels; ++k)
      turn_back(
          sign * fma(broadcast(modes.rate[k]), t, fma(broadcast(f.m[k]), apart, -(modes.photons[k] * phase))),
          k, a);
  };
  // Of levels (sign -1) or modes at the time t what they are in the other ones.
  const auto changed = [&](real t, double sign, int Term::*from, int Term::*to, const Amplitudes& b) {
    const real angle = fma(broadcast(omega), t, phase);
    const Phasor each = phasor(angle);
    Phasor p = phasor(modes.first_harmonic * angle);
    Amplitudes out;
    for (int k = 0; k < f.levels; ++k) out.re[k] = out.im[k] = broadcast(0);
    for (int n = 0, i = 0; n < modes.harmonics; ++n) {
      for (; i < modes.end[n]; ++i) {
        const Term& term = modes.term[i];
        const real re = fma(broadcast(term.re), p.c, -(term.im * p.s)),
                   im = sign * fma(broadcast(term.re), p.s, term.im * p.c);
        real &to_re = out.re[term.*to], &to_im = out.im[term.*to];
        to_re = fma(re, b.re[term.*from], fnma(im, b.im[term.*from], to_re));
        to_im = fma(re, b.im[term.*from], fma(im, b.re[term.*from], to_im));
      }
      p = p * each;
    }
    return out;
  };
  turn(begin, 1);
  a = changed(begin, -1, &Term::level, &Term::mode, a);
  for (int k = 0; k < f.levels; ++k) turn_back(modes.quasi[k] * (end - begin), k, a);
  a = changed(end, 1, &Term::mode, &Term::level, a);
  turn(end, -1);
}

}  // namespace rabiline::RABILINE_ISA
