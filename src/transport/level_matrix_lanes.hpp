#pragma once
// The Hamiltonian of levels in a frame that follows the field, its exponential and what it leaves to phases,
// for kernels only: what LevelManifold's numbers stand for, in lanes.
#include "transport/level_course.hpp"
#include "transport/vector_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// Numbers in a row that are aligned to nothing more than themselves.
RABILINE_LANES real row_at(const double* p) {
  using numbers [[gnu::aligned(8), gnu::may_alias]] = double __attribute__((vector_size(8 * lane_count)));
  return *reinterpret_cast<const numbers*>(p);
}

struct Amplitudes {
  real re[most_levels], im[most_levels];
};
/// A Hermitian matrix over the levels of a manifold: [coupling] <to|H|from>.
struct LevelMatrix {
  real diagonal[most_levels];
  real re[most_couplings], im[most_couplings];
};

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

constexpr int most_row = (3 * most_levels + most_couplings + most_pairs + 7) / 8 * 8;
/// The first numbers of LevelManifold::rows at theta, for each lane.
[[gnu::noinline]] inline void look_up(const LevelManifold& f, int count, real theta, real* values) {
  constexpr double pi = 3.141592653589793;
  const real place = fma(theta, broadcast(f.cells / pi), broadcast(0.5 * f.cells));
  const real cell = max(broadcast(0), min(floor(place), broadcast(f.cells - 1)));
  const real x = fma(place - cell, broadcast(2), broadcast(-1));
  alignas(64) double found[lane_count][most_row];
  for (int k = 0; k < lane_count; ++k) {
    const double* row = f.rows + static_cast<long>(lane(cell, k)) * (level_powers * f.width);
    const real at = broadcast(lane(x, k));
    for (int i = 0; i < count; i += lane_count) {
      real sum = row_at(row + (level_powers - 1) * f.width + i);
      for (int power = level_powers - 2; power >= 0; --power)
        sum = fma(sum, at, row_at(row + power * f.width + i));
      store(found[k] + i, sum);
    }
  }
  for (int i = 0; i < count; ++i) {
    real value = broadcast(0);
    for (int k = 0; k < lane_count; ++k) set_lane(value, k, found[k][i]);
    values[i] = value;
  }
}

/// H in the frame, in rad/s times `weight`, added to what is there.
inline void add_matrix(const LevelManifold& f, const FollowedField& at, real weight, LevelMatrix& h) {
  real values[3 * most_levels + most_couplings];
  const real ratio = at.signed_size * (1 / f.scale), over = 1.0 / fma(ratio, ratio, broadcast(1));
  look_up(f, 3 * f.levels + f.couplings, atan(ratio), values);
  const real root = sqrt(fma(ratio, ratio, broadcast(1))), energy = weight * root, about = weight * at.turn_3;
  const real theta_rate = at.size_rate * over * (1 / f.scale), cosine = energy * over,
             turning = cosine * fma(at.turn_1, at.turn_1, at.turn_2 * at.turn_2),
             stretching = cosine * theta_rate * theta_rate;
  const real *shift_1 = values + f.levels + f.couplings, *shift_2 = shift_1 + f.levels;
  for (int k = 0; k < f.levels; ++k)
    h.diagonal[k] = fma(
        energy, values[k],
        fma(turning, shift_1[k], fma(stretching, shift_2[k], fnma(about, broadcast(f.m[k]), h.diagonal[k]))));
  const real re = -0.5 * weight * at.turn_1, im = -0.5 * weight * at.turn_2, stretch = -weight * theta_rate;
  const real* coupled = values + f.levels;
  for (int j = 0; j < f.ladders; ++j) {
    h.re[j] = fma(re, coupled[j], h.re[j]);
    h.im[j] = fma(im, coupled[j], h.im[j]);
  }
  for (int j = f.ladders; j < f.couplings; ++j) h.im[j] = fma(stretch, coupled[j], h.im[j]);
}
inline void clear(const LevelManifold& f, LevelMatrix& h) {
  for (int k = 0; k < f.levels; ++k) h.diagonal[k] = broadcast(0);
  for (int j = 0; j < f.couplings; ++j) h.re[j] = h.im[j] = broadcast(0);
}

/// What bounds the eigenvalues' size.
inline real radius_of(const LevelManifold& f, const LevelMatrix& h) {
  real most = broadcast(0), coupled2 = broadcast(0);
  for (int k = 0; k < f.levels; ++k) most = max(abs(h.diagonal[k]), most);
  for (int j = 0; j < f.couplings; ++j) coupled2 = max(fma(h.re[j], h.re[j], h.im[j] * h.im[j]), coupled2);
  return fma(broadcast(f.most_of_one), sqrt(coupled2), most);
}

constexpr double largest_radius = 12;
/// So many terms of the series of exp(-i H) leave less than 1e-13 out.
RABILINE_LANES real terms_needed(real radius) {
  return floor(min(fma(radius, broadcast(10), broadcast(7)), fma(radius, broadcast(5.5), broadcast(9.5))));
}
/// 1/j for lanes that need the term, else 0.
RABILINE_LANES real share_of_term(real last, int j) {
  return select(last >= broadcast(j), broadcast(1.0 / j), broadcast(0));
}

/// exp(-i H) a of levels in a chain.
template <int levels>
[[gnu::noinline]] void exponentiate_chain(const LevelMatrix& h, real last, Amplitudes& a) {
  real term_re[levels], term_im[levels], re[levels], im[levels];
  for (int k = 0; k < levels; ++k) {
    term_re[k] = re[k] = a.re[k];
    term_im[k] = im[k] = a.im[k];
  }
  for (int j = 1; any(last >= broadcast(j)); ++j) {
    const real by = share_of_term(last, j);
    real above_re = broadcast(0), above_im = broadcast(0);  // from the level before
#pragma GCC unroll 16
    for (int k = 0; k < levels; ++k) {
      real h_re = fma(h.diagonal[k], term_re[k], above_re), h_im = fma(h.diagonal[k], term_im[k], above_im);
      if (k + 1 < levels) {
        const real c_re = h.re[k], c_im = h.im[k];
        h_re = fma(c_re, term_re[k + 1], fma(c_im, term_im[k + 1], h_re));
        h_im = fma(c_re, term_im[k + 1], fnma(c_im, term_re[k + 1], h_im));
        above_re = fnma(c_im, term_im[k], c_re * term_re[k]);
        above_im = fma(c_im, term_re[k], c_re * term_im[k]);
      }
      term_re[k] = by * h_im;
      term_im[k] = -by * h_re;
      re[k] = re[k] + term_re[k];
      im[k] = im[k] + term_im[k];
    }
  }
  for (int k = 0; k < levels; ++k) {
    a.re[k] = re[k];
    a.im[k] = im[k];
  }
}
[[gnu::noinline]] inline void exponentiate_any(const LevelManifold& f, const LevelMatrix& h, real last,
                                               Amplitudes& a) {
  Amplitudes term = a;
  for (int j = 1; any(last >= broadcast(j)); ++j) {
    const real by = share_of_term(last, j);
    real re[most_levels], im[most_levels];
    for (int k = 0; k < f.levels; ++k) {
      re[k] = h.diagonal[k] * term.re[k];
      im[k] = h.diagonal[k] * term.im[k];
    }
    for (int c = 0; c < f.couplings; ++c) {
      const int to = f.to[c], from = f.from[c];
      re[to] = fma(h.re[c], term.re[from], fnma(h.im[c], term.im[from], re[to]));
      im[to] = fma(h.re[c], term.im[from], fma(h.im[c], term.re[from], im[to]));
      re[from] = fma(h.re[c], term.re[to], fma(h.im[c], term.im[to], re[from]));
      im[from] = fma(h.re[c], term.im[to], fnma(h.im[c], term.re[to], im[from]));
    }
    for (int k = 0; k < f.levels; ++k) {
      term.re[k] = by * im[k];
      term.im[k] = -by * re[k];
      a.re[k] = a.re[k] + term.re[k];
      a.im[k] = a.im[k] + term.im[k];
    }
  }
}
/// exp(-i H) a by its series; no more than the largest radius.
inline void exponentiate(const LevelManifold& f, const LevelMatrix& h, Amplitudes& a) {
  const real last = terms_needed(min(radius_of(f, h), broadcast(largest_radius)));
  switch (f.is_chain ? f.levels : 0) {
    case 2:
      return exponentiate_chain<2>(h, last, a);
    case 3:
      return exponentiate_chain<3>(h, last, a);
    case 4:
      return exponentiate_chain<4>(h, last, a);
    case 5:
      return exponentiate_chain<5>(h, last, a);
    case 6:
      return exponentiate_chain<6>(h, last, a);
    case 7:
      return exponentiate_chain<7>(h, last, a);
    case 8:
      return exponentiate_chain<8>(h, last, a);
    case 9:
      return exponentiate_chain<9>(h, last, a);
    default:
      return exponentiate_any(f, h, last, a);
  }
}
RABILINE_LANES void choose(int levels, mask m, const Amplitudes& yes, Amplitudes& a) {
  for (int k = 0; k < levels; ++k) {
    a.re[k] = select(m, yes.re[k], a.re[k]);
    a.im[k] = select(m, yes.im[k], a.im[k]);
  }
}

/// From the matrices at the Gauss points to those of the two exponentials.
inline void mix(const LevelManifold& f, LevelMatrix& one, LevelMatrix& two) {
  const auto both = [](real& first, real& second) {
    constexpr double near = 0.25 - 0.28867513459481288225, far = 0.25 + 0.28867513459481288225;
    const real sum = far * first + near * second;
    second = near * first + far * second;
    first = sum;
  };
  for (int k = 0; k < f.levels; ++k) both(one.diagonal[k], two.diagonal[k]);
  for (int j = 0; j < f.couplings; ++j) {
    both(one.re[j], two.re[j]);
    both(one.im[j], two.im[j]);
  }
}
/// By how much two states differ, but for a common phase.
inline real difference(int levels, const Amplitudes& one, const Amplitudes& other) {
  real square = broadcast(0), phase = broadcast(0);
  for (int k = 0; k < levels; ++k) {
    const real re = one.re[k] - other.re[k], im = one.im[k] - other.im[k];
    square = fma(re, re, fma(im, im, square));
    phase = fma(other.re[k], im, fnma(other.im[k], re, phase));
  }
  return sqrt(max(broadcast(0), fnma(phase, phase, square)));
}

/// How weak couplings are at one moment against what they couple.
struct Calm {
  real ratio;   // the largest |V_kl / (E_k - E_l)|
  real uneven;  // by how much the gaps |E_k - E_l| differ, over the largest: 0 of a ladder, whose second
                // order is diagonal
  real gap;     // [rad/s] the smallest
  /// What the dressed states leave out, for a field that changes by `changes` within 1/gap.
  RABILINE_LANES real left_out(real changes) const {
    return ratio * max(ratio * max(ratio, uneven), 9.0 * changes * changes);
  }
};
inline Calm calm_of(const LevelManifold& f, const LevelMatrix& h) {
  real ratio2 = broadcast(0), least = broadcast(1e300), most = broadcast(tiny);
  for (int j = 0; j < f.couplings; ++j) {
    const real apart = abs(h.diagonal[f.to[j]] - h.diagonal[f.from[j]]),
               coupled2 = fma(h.re[j], h.re[j], h.im[j] * h.im[j]);
    const mask acts = coupled2 > broadcast(0);
    ratio2 = select(acts, max(coupled2 / max(apart * apart, broadcast(tiny)), ratio2), ratio2);
    least = min(apart, least);
    most = max(apart, most);
  }
  return {sqrt(ratio2), (most - least) / most, least};
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
