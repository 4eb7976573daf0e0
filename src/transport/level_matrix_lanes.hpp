#pragma once
// The Hamiltonian of levels in a frame that follows the field and what it leaves to phases, for kernels only:
// what LevelManifold's numbers stand for, in lanes.
#include "transport/level_course.hpp"
#include "transport/vector_lanes.hpp"

namespace rabiline::RABILINE_ISA {

struct Amplitudes {
  real re[most_levels], im[most_levels];
};
/// A Hermitian matrix over the levels of a manifold: [coupling] <to|H|from>.
struct LevelMatrix {
  real diagonal[most_levels];
  real re[most_couplings], im[most_couplings];
};

/// exp(-i angle) times one of them.
RABILINE_LANES void turn_back(real angle, int level, Amplitudes& a) {
  const Phasor p = phasor(angle);
  const real re = fma(a.im[level], p.s, a.re[level] * p.c);
  a.im[level] = fnma(a.re[level], p.s, a.im[level] * p.c);
  a.re[level] = re;
}

/// B and dB/dt where a particle is.
struct FieldAtTime {
  Vector b, rate;
};
/// The third axis and the first one, across it.
struct LevelAxes {
  Vector third, first;
  RABILINE_LANES Vector second() const { return cross(third, first); }
};
RABILINE_LANES Vector times(real s, const Vector& v) { return {s * v.x, s * v.y, s * v.z}; }
RABILINE_LANES real length_of(const Vector& v) { return sqrt(dot(v, v)); }
constexpr double tiny = 0x1p-500;
/// [rad/(s T)] Of an electron, and more: faster than any levels turn in a field.
constexpr double electron_rate = 2e11;

/// Axes moved along by the shortest turn that takes the third to n; `over` is 1/(1 + n . third).
RABILINE_LANES LevelAxes moved_to(const Vector& n, const LevelAxes& a, real over) {
  const real along = dot(a.first, n) * over;
  return {n, add(add(a.first, -along, n), -along, a.third)};
}
/// The same, without rounding that adds up.
RABILINE_LANES LevelAxes moved_to(const Vector& n, const LevelAxes& a) {
  Vector first = moved_to(n, a, 1.0 / (1.0 + dot(n, a.third))).first;
  first = add(first, -dot(first, n), n);
  return {n, times(1.0 / length_of(first), first)};
}

/// What a field does in the frame of the axes `from` moved to n = +-b/|b|, whichever is nearer.
struct FollowedField {
  Vector n, first;
  real size, signed_size, size_rate;  // [T], [T/s]
  real turn_1, turn_2, turn_3;        // [rad/s] of the frame, about its own axes
  real cosine;                        // of the turn from the third axis of `from`
};
inline FollowedField followed(const FieldAtTime& field, const LevelAxes& from) {
  FollowedField f;
  f.size = length_of(field.b);
  const mask none = f.size < broadcast(tiny);
  const real side = select(dot(field.b, from.third) < broadcast(0), broadcast(-1), broadcast(1));
  f.signed_size = side * f.size;
  const real over = side / select(none, broadcast(1), f.size);
  f.n = select(none, from.third, times(over, field.b));
  f.cosine = dot(f.n, from.third);
  f.size_rate = dot(f.n, field.rate);
  const Vector turning = times(select(none, broadcast(0), over), add(field.rate, -f.size_rate, f.n));
  const real half = 1.0 / (1.0 + f.cosine);
  const LevelAxes here = moved_to(f.n, from, half);
  f.first = here.first;
  f.turn_1 = -dot(turning, here.second());
  f.turn_2 = dot(turning, here.first);
  f.turn_3 = -dot(cross(from.third, f.n), turning) * half;
  return f;
}

constexpr int most_row = (4 * most_levels + most_couplings + most_pairs + 7) / 8 * 8;
/// Rows and columns of lanes change places.
RABILINE_LANES void transpose(real (&row)[lane_count]) {
  for (int step = 1; step < lane_count; step *= 2) {
    real next[lane_count];
    for (int i = 0; i < lane_count / 2; ++i)
      interleave(row[i], row[i + lane_count / 2], next[2 * i], next[2 * i + 1]);
    for (int i = 0; i < lane_count; ++i) row[i] = next[i];
  }
}
/// The first numbers of LevelManifold::rows at theta, for each lane; `values` has whole lanes of them.
[[gnu::noinline]] inline void look_up(const LevelManifold& f, int count, real theta, real* values) {
  constexpr double pi = 3.141592653589793;
  const real place = fma(theta, broadcast(f.cells / pi), broadcast(0.5 * f.cells));
  const real cell = max(broadcast(0), min(floor(place), broadcast(f.cells - 1)));
  const real x = fma(place - cell, broadcast(2), broadcast(-1));
  const double* rows[lane_count];
  for (int k = 0; k < lane_count; ++k)
    rows[k] = f.rows + static_cast<long>(lane(cell, k)) * (level_powers * f.width);
  for (int i = 0; i < count; i += lane_count) {
    real found[lane_count];
    for (int k = 0; k < lane_count; ++k) {
      const real at = broadcast(lane(x, k));
      real sum = load(rows[k] + (level_powers - 1) * f.width + i);
      for (int power = level_powers - 2; power >= 0; --power)
        sum = fma(sum, at, load(rows[k] + power * f.width + i));
      found[k] = sum;
    }
    transpose(found);
    for (int k = 0; k < lane_count; ++k) values[i + k] = found[k];
  }
}

/// H in the frame, in rad/s.
inline void set_matrix(const LevelManifold& f, const FollowedField& at, LevelMatrix& h) {
  real values[3 * most_levels + most_couplings];
  const real ratio = at.signed_size * (1 / f.scale), over = 1.0 / fma(ratio, ratio, broadcast(1));
  look_up(f, 3 * f.levels + f.couplings, atan(ratio), values);
  const real root = sqrt(fma(ratio, ratio, broadcast(1)));
  const real theta_rate = at.size_rate * over * (1 / f.scale), cosine = root * over,
             turning = cosine * fma(at.turn_1, at.turn_1, at.turn_2 * at.turn_2),
             stretching = cosine * theta_rate * theta_rate;
  const real *shift_1 = values + f.levels + f.couplings, *shift_2 = shift_1 + f.levels;
  for (int k = 0; k < f.levels; ++k)
    h.diagonal[k] =
        fma(root, values[k],
            fma(turning, shift_1[k], fnma(at.turn_3, broadcast(f.m[k]), stretching * shift_2[k])));
  const real* coupled = values + f.levels;
  for (int j = 0; j < f.ladders; ++j) {
    h.re[j] = -0.5 * at.turn_1 * coupled[j];
    h.im[j] = -0.5 * at.turn_2 * coupled[j];
  }
  for (int j = f.ladders; j < f.couplings; ++j) {
    h.re[j] = broadcast(0);
    h.im[j] = -theta_rate * coupled[j];
  }
}

/// The strongest coupling.
inline real coupling_of(const LevelManifold& f, const LevelMatrix& h) {
  real coupled2 = broadcast(0);
  for (int j = 0; j < f.couplings; ++j) coupled2 = max(fma(h.re[j], h.re[j], h.im[j] * h.im[j]), coupled2);
  return sqrt(coupled2);
}
/// What bounds the eigenvalues' size.
inline real radius_of(const LevelManifold& f, const LevelMatrix& h) {
  real most = broadcast(0);
  for (int k = 0; k < f.levels; ++k) most = max(abs(h.diagonal[k]), most);
  return fma(broadcast(f.most_of_one), coupling_of(f, h), most);
}

/// How weak couplings are at one moment against what they couple.
struct Calm {
  real ratio;   // the largest |V_kl / (E_k - E_l)|
  real uneven;  // by how much the gaps |E_k - E_l| differ, over the largest: 0 of a ladder, whose second
                // order is diagonal
  real gap;     // [rad/s] the smallest
  real swift;   // [rad/s] about the fastest that coupled levels turn against one another
  /// What the dressed states leave out, for a field that changes by `changes` within 1/gap.
  RABILINE_LANES real left_out(real changes) const {
    return ratio * max(ratio * max(ratio, uneven), 9.0 * changes * changes);
  }
};
inline Calm calm_of(const LevelManifold& f, const LevelMatrix& h) {
  real ratio2 = broadcast(0), strongest2 = broadcast(0), least = broadcast(1e300), most = broadcast(tiny);
  for (int j = 0; j < f.couplings; ++j) {
    const real apart = abs(h.diagonal[f.to[j]] - h.diagonal[f.from[j]]),
               coupled2 = fma(h.re[j], h.re[j], h.im[j] * h.im[j]);
    const mask acts = coupled2 > broadcast(0);
    ratio2 = select(acts, max(coupled2 / max(apart * apart, broadcast(tiny)), ratio2), ratio2);
    strongest2 = max(coupled2, strongest2);
    least = min(apart, least);
    most = max(apart, most);
  }
  return {sqrt(ratio2), (most - least) / most, least, fma(broadcast(2), sqrt(strongest2), most)};
}
/// V_kl/(E_k - E_l), in place of V.
inline void divide_by_gaps(const LevelManifold& f, LevelMatrix& h) {
  for (int j = 0; j < f.couplings; ++j) {
    const real apart = h.diagonal[f.to[j]] - h.diagonal[f.from[j]];
    const real over = select(abs(apart) > broadcast(tiny), 1.0 / apart, broadcast(0));
    h.re[j] = h.re[j] * over;
    h.im[j] = h.im[j] * over;
  }
}
/// The energies with what couplings shift them by to second order.
inline void shifted_energies(const LevelManifold& f, const LevelMatrix& h, real* energy) {
  for (int k = 0; k < f.levels; ++k) energy[k] = h.diagonal[k];
  for (int j = 0; j < f.couplings; ++j) {
    const real apart = h.diagonal[f.to[j]] - h.diagonal[f.from[j]];
    const real shift =
        select(abs(apart) > broadcast(tiny), fma(h.re[j], h.re[j], h.im[j] * h.im[j]) / apart, broadcast(0));
    energy[f.to[j]] = energy[f.to[j]] + shift;
    energy[f.from[j]] = energy[f.from[j]] - shift;
  }
}

}  // namespace rabiline::RABILINE_ISA
