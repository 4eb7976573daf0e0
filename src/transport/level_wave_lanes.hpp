#pragma once
// What drives levels in the rotating-wave approximation, in the frame in which it stands nearly still, for
// kernels only: WaveFrame's lanes.
#include "transport/level_matrix_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// The field is Re(c exp(-i omega t)) with c = re + i im.
struct Wave {
  Vector re, im;
};
inline Wave wave_at(const LevelWave& wave, const real* phases, const mask* on, real t, const Vector& r) {
  const real zero = broadcast(0);
  Wave c{{zero, zero, zero}, {zero, zero, zero}};
  for (int i = 0; i < wave.drives; ++i) {
    const DriveTerm& drive = wave.drive[i];
    const Phasor p = phasor(angle_at(drive, phases[i], t, r));
    const real size = drive.spin_rate * select(on[i], share_of(drive, r), broadcast(0)), cosine = size * p.c,
               sine = size * p.s;
    const double *a = drive.first, *b = drive.second;
    c.re = add(c.re, broadcast(1),
               {fma(cosine, broadcast(a[0]), sine * b[0]), fma(cosine, broadcast(a[1]), sine * b[1]),
                fma(cosine, broadcast(a[2]), sine * b[2])});
    c.im = add(c.im, broadcast(1),
               {fnma(sine, broadcast(a[0]), cosine * b[0]), fnma(sine, broadcast(a[1]), cosine * b[1]),
                fnma(sine, broadcast(a[2]), cosine * b[2])});
  }
  return c;
}

struct ComplexReal {
  real re, im;
};
/// V/(E - E') with what is nearer than V bounded by it, times V.
RABILINE_LANES real shift_by(real square, real apart) {
  return square * apart / max(fma(apart, apart, square), broadcast(tiny));
}

/// H in the frame that moves with the field and turns with the wave, in rad/s; its couplings are those of
/// wave.standing.
[[gnu::noinline]] inline void set_matrix(const LevelManifold& f, const LevelWave& wave,
                                         const FollowedField& at, const Wave& c, LevelMatrix& h) {
  real values[most_row];
  const real ratio = at.signed_size * (1 / f.scale), over = 1.0 / fma(ratio, ratio, broadcast(1)),
             root = sqrt(fma(ratio, ratio, broadcast(1)));
  const int first_own = 3 * f.levels + f.couplings + f.pairs;
  look_up(f, wave.paths > 0 ? f.width : first_own, atan(ratio), values);
  const real theta_rate = at.size_rate * over * (1 / f.scale), cosine = root * over,
             turning = cosine * fma(at.turn_1, at.turn_1, at.turn_2 * at.turn_2),
             stretching = cosine * theta_rate * theta_rate;
  const real *coupled = values + f.levels, *shift_1 = coupled + f.couplings, *shift_2 = shift_1 + f.levels,
             *pair = shift_2 + f.levels;
  // Energies [rad/s] in no frame of the wave, for what is left to second order.
  real energy[most_levels], shift[most_levels];
  for (int k = 0; k < f.levels; ++k) {
    energy[k] = fma(root, values[k], broadcast(f.taken_off[k]));
    shift[k] = fma(turning, shift_1[k], stretching * shift_2[k]);
  }
  const auto move = [&](int j) -> ComplexReal {
    if (j >= f.ladders) return {broadcast(0), -theta_rate * coupled[j]};
    return {-0.5 * at.turn_1 * coupled[j], -0.5 * at.turn_2 * coupled[j]};
  };
  const auto apply = [&](int one, int other, real by) {
    shift[one] = shift[one] + by;
    shift[other] = shift[other] - by;
  };
  for (int i = 0; i < wave.moves; ++i) {
    const int j = wave.move[i];
    const ComplexReal v = move(j);
    apply(f.to[j], f.from[j], shift_by(fma(v.re, v.re, v.im * v.im), energy[f.to[j]] - energy[f.from[j]]));
  }
  // (c_1 + i c_2)/4 and c_3/2 lead from m to m - 1 and m with a photon taken up; those of the conjugate of c
  // give one off.
  const Vector second = cross(at.n, at.first);
  const real by = broadcast(0.25 * f.moment), c1r = dot(c.re, at.first), c1i = dot(c.im, at.first),
             c2r = dot(c.re, second), c2i = dot(c.im, second), c3r = 2.0 * by * dot(c.re, at.n),
             c3i = 2.0 * by * dot(c.im, at.n);
  const ComplexReal lowering[2] = {{by * (c1r - c2i), by * (c1i + c2r)},
                                   {by * (c1r + c2i), by * (c2r - c1i)}},
                    along[2] = {{c3r, c3i}, {c3r, -c3i}};
  for (int p = 0; p < f.pairs; ++p) {
    const ComplexReal* v = f.m[f.low[p]] == f.m[f.high[p]] ? along : lowering;
    const real apart = energy[f.low[p]] - energy[f.high[p]], square = pair[p] * pair[p];
    for (int side = 0; side < 2; ++side)
      if (wave.left_out[p] & (1 << side))
        apply(f.low[p], f.high[p],
              shift_by(square * fma(v[side].re, v[side].re, v[side].im * v[side].im),
                       apart - (side == 0 ? wave.omega : -wave.omega)));
  }
  const auto side_of = [&](const PhotonLeg& leg) -> ComplexReal {
    const bool own = leg.pair >= f.pairs;
    const ComplexReal& side =
        (own || f.m[f.low[leg.pair]] == f.m[f.high[leg.pair]] ? along : lowering)[leg.side];
    return {pair[leg.pair] * side.re, (leg.conjugate ? -1.0 : 1.0) * pair[leg.pair] * side.im};
  };
  for (int j = 0; j < wave.of_first; ++j) {
    const int photons = wave.photons[j], number = wave.number[j];
    const ComplexReal v = photons == 0 ? move(number) : side_of({number, photons > 0 ? 0 : 1});
    h.re[j] = v.re;
    h.im[j] = v.im;
  }
  for (int j = wave.of_first; j < wave.standing.couplings; ++j) h.re[j] = h.im[j] = broadcast(0);
  for (int i = 0; i < wave.paths; ++i) {
    const TwoPhotonPath& path = wave.path[i];
    const int j = path.coupling;
    const ComplexReal a = side_of(path.last), b = side_of(path.first);
    const real nearest = 0.5 * (fma(a.re, a.re, a.im * a.im) + fma(b.re, b.re, b.im * b.im)),
               to = energy[wave.standing.to[j]] - energy[path.by] - path.last_taken_up * wave.omega,
               from = energy[wave.standing.from[j]] - energy[path.by] + path.first_taken_up * wave.omega;
    const auto inverse = [&](real apart) { return apart / max(fma(apart, apart, nearest), broadcast(tiny)); };
    const real by_both = 0.5 * (inverse(to) + inverse(from));
    h.re[j] = fma(by_both, fma(a.re, b.re, -(a.im * b.im)), h.re[j]);
    h.im[j] = fma(by_both, fma(a.re, b.im, a.im * b.re), h.im[j]);
  }
  for (int k = 0; k < f.levels; ++k) {
    const real own = fma(root, values[k], shift[k] + (f.taken_off[k] - wave.rate[k]));
    h.diagonal[k] = fnma(at.turn_3, broadcast(f.m[k]), own);
  }
}

/// Amplitudes get the phases of the wave's frame at the time t, instead of those of the manifold's energies
/// at B = 0; or the other way round.
inline void change_frame(const LevelManifold& f, const LevelWave& wave, real t, double sign, Amplitudes& a) {
  for (int k = 0; k < f.levels; ++k) turn_back((sign * (f.taken_off[k] - wave.rate[k])) * t, k, a);
}
/// Levels of a field against the third axis are named as those of one along it: the axes turn about the first
/// by half a turn.
inline void turn_over(const LevelManifold& f, mask lanes, Amplitudes& a) {
  const Amplitudes before = a;
  for (int k = 0; k < f.levels; ++k) {
    const int to = f.mirror[k];
    a.re[to] = select(lanes, f.mirror_sign[k] * before.re[k], before.re[to]);
    a.im[to] = select(lanes, f.mirror_sign[k] * before.im[k], before.im[to]);
  }
}

}  // namespace rabiline::RABILINE_ISA
