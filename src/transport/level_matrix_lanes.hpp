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
/// exp(-i H) = J_0(R) + 2 sum over k of J_k(R) (-i)^k T_k(H/R), which holds and converges where no eigenvalue
/// is beyond R (H. Tal-Ezer and R. Kosloff, J. Chem. Phys. 81, 3967 (1984)).
class ChebyshevSeries {
  static constexpr int most_terms = 40;

 public:
  int terms = 1;
  real weight[most_terms];
  real twice;  // 2/R
  inline explicit ChebyshevSeries(real bound) {
    const real radius = max(broadcast(0.1), min(bound, broadcast(largest_radius)));
    last = floor(min(min(fma(radius, broadcast(6), broadcast(8)), fma(radius, broadcast(2.6), broadcast(12))),
                     fma(radius, broadcast(2), broadcast(14))));
    twice = 2.0 / radius;
    // Downwards by J_k-1 = (2k/R) J_k - J_k+1 from some number, then J_0 + 2 J_2 + 2 J_4 + ... = 1.
    real above = broadcast(0), here = broadcast(0), even = broadcast(0);
    while (needs(terms)) ++terms;
    weight[terms] = broadcast(0);
    for (int k = terms - 1; k > 0; --k) {
      here = select(last == broadcast(k), broadcast(1), here);
      weight[k] = 2.0 * here;
      if (k % 2 == 0) even = even + weight[k];
      const real below = fnma(broadcast(1), above, (k * twice) * here);
      above = here;
      here = below;
    }
    const real over = 1.0 / (here + even);
    weight[0] = here * over;
    for (int k = 1; k < terms; ++k) weight[k] = weight[k] * over;
  }

 private:
  bool needs(int k) const { return any(last >= broadcast(k)); }
  real last;  // of each lane, to 1e-12; its other weights are 0
};

/// exp(-i H) a of levels in a chain.
template <int levels>
[[gnu::noinline]] void exponentiate_chain(const LevelMatrix& h, const ChebyshevSeries& series,
                                          Amplitudes& a) {
  struct Term {
    real re[levels], im[levels];
  } one, other;
  for (int k = 0; k < levels; ++k) {
    one.re[k] = a.re[k];
    one.im[k] = a.im[k];
    other.re[k] = other.im[k] = broadcast(0);
    a.re[k] = series.weight[0] * a.re[k];
    a.im[k] = series.weight[0] * a.im[k];
  }
  // (-i)^k+1 T_k+1 = -2i (H/R) (-i)^k T_k + (-i)^k-1 T_k-1, the first without 2: in place of the one before.
  const auto go_on = [&](real by, real weight, const Term& term, Term& next) {
    real above_re = broadcast(0), above_im = broadcast(0);  // from the level before
#pragma GCC unroll 16
    for (int k = 0; k < levels; ++k) {
      real h_re = fma(h.diagonal[k], term.re[k], above_re), h_im = fma(h.diagonal[k], term.im[k], above_im);
      if (k + 1 < levels) {
        const real c_re = h.re[k], c_im = h.im[k];
        h_re = fma(c_re, term.re[k + 1], fma(c_im, term.im[k + 1], h_re));
        h_im = fma(c_re, term.im[k + 1], fnma(c_im, term.re[k + 1], h_im));
        above_re = fnma(c_im, term.im[k], c_re * term.re[k]);
        above_im = fma(c_im, term.re[k], c_re * term.im[k]);
      }
      next.re[k] = fma(by, h_im, next.re[k]);
      next.im[k] = fnma(by, h_re, next.im[k]);
      a.re[k] = fma(weight, next.re[k], a.re[k]);
      a.im[k] = fma(weight, next.im[k], a.im[k]);
    }
  };
  go_on(0.5 * series.twice, series.weight[1], one, other);
  for (int k = 2; k < series.terms; k += 2) {
    go_on(series.twice, series.weight[k], other, one);
    go_on(series.twice, series.weight[k + 1], one, other);
  }
}
[[gnu::noinline]] inline void exponentiate_any(const LevelManifold& f, const LevelMatrix& h,
                                               const ChebyshevSeries& series, Amplitudes& a) {
  Amplitudes term = a, last;
  for (int k = 0; k < f.levels; ++k) {
    last.re[k] = last.im[k] = broadcast(0);
    a.re[k] = series.weight[0] * a.re[k];
    a.im[k] = series.weight[0] * a.im[k];
  }
  for (int j = 1; j < series.terms; ++j) {
    const real by = j == 1 ? 0.5 * series.twice : series.twice;
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
      const real next_re = fma(by, im[k], last.re[k]), next_im = fnma(by, re[k], last.im[k]);
      last.re[k] = term.re[k];
      last.im[k] = term.im[k];
      term.re[k] = next_re;
      term.im[k] = next_im;
      a.re[k] = fma(series.weight[j], next_re, a.re[k]);
      a.im[k] = fma(series.weight[j], next_im, a.im[k]);
    }
  }
}
/// exp(-i H) a, right where no eigenvalue is beyond the largest radius.
inline void exponentiate(const LevelManifold& f, const LevelMatrix& h, real bound, Amplitudes& a) {
  const ChebyshevSeries series(bound);
  switch (f.is_chain ? f.levels : 0) {
    case 2:
      return exponentiate_chain<2>(h, series, a);
    case 3:
      return exponentiate_chain<3>(h, series, a);
    case 4:
      return exponentiate_chain<4>(h, series, a);
    case 5:
      return exponentiate_chain<5>(h, series, a);
    case 6:
      return exponentiate_chain<6>(h, series, a);
    case 7:
      return exponentiate_chain<7>(h, series, a);
    case 8:
      return exponentiate_chain<8>(h, series, a);
    case 9:
      return exponentiate_chain<9>(h, series, a);
    default:
      return exponentiate_any(f, h, series, a);
  }
}
inline void exponentiate(const LevelManifold& f, const LevelMatrix& h, Amplitudes& a) {
  exponentiate(f, h, radius_of(f, h), a);
}
RABILINE_LANES void choose(int levels, mask m, const Amplitudes& yes, Amplitudes& a) {
  for (int k = 0; k < levels; ++k) {
    a.re[k] = select(m, yes.re[k], a.re[k]);
    a.im[k] = select(m, yes.im[k], a.im[k]);
  }
}

/// Calls act(number) where number(matrix) is one of the real numbers of a matrix, for all of them.
template <typename Act>
RABILINE_LANES void for_each_number(const LevelManifold& f, const Act& act) {
  for (int k = 0; k < f.levels; ++k) act([=](auto& h) -> auto& { return h.diagonal[k]; });
  for (int j = 0; j < f.couplings; ++j) {
    act([=](auto& h) -> auto& { return h.re[j]; });
    act([=](auto& h) -> auto& { return h.im[j]; });
  }
}
inline void copy_matrix(const LevelManifold& f, const LevelMatrix& from, LevelMatrix& to) {
  for_each_number(f, [&](auto&& number) { number(to) = number(from); });
}
constexpr double lobatto_inner = 0.65465367070797714380;  // sqrt(3/7)
constexpr double lobatto_point[5] = {-1, -lobatto_inner, 0, lobatto_inner, 1};
/// From the values at Lobatto's five points to the factors of P_0 to P_4, times h.
inline void to_legendre(const LevelManifold& f, real h, LevelMatrix* at) {
  for_each_number(f, [&](auto&& number) {
    const real outer = h * (number(at[0]) + number(at[4])), inner = h * (number(at[1]) + number(at[3])),
               middle = h * number(at[2]), out = h * (number(at[4]) - number(at[0])),
               in = h * (number(at[3]) - number(at[1]));
    number(at[0]) = (1.0 / 20) * outer + (49.0 / 180) * inner + (16.0 / 45) * middle;
    number(at[1]) = (3.0 / 20) * out + (49.0 / 60 * lobatto_inner) * in;
    number(at[2]) = (1.0 / 4) * outer + (7.0 / 36) * inner - (8.0 / 9) * middle;
    number(at[3]) = 0.5 * out - number(at[1]);
    number(at[4]) = (1.0 / 5) * outer - (7.0 / 15) * inner + (8.0 / 15) * middle;
  });
}
/// What a step of a time-dependent H exponentiates one after the other: shares of the factors of P_0 to P_3,
/// those of two steps of half the length by what the polynomials are there.
constexpr double whole_step[2][4] = {{1.0 / 2, -1.0 / 3, 0, 0}, {1.0 / 2, 1.0 / 3, 0, 0}};
constexpr double half_steps[4][4] = {{1.0 / 4, -5.0 / 24, 1.0 / 8, -1.0 / 32},
                                     {1.0 / 4, -1.0 / 24, -1.0 / 8, 3.0 / 32},
                                     {1.0 / 4, 1.0 / 24, -1.0 / 8, -3.0 / 32},
                                     {1.0 / 4, 5.0 / 24, 1.0 / 8, 1.0 / 32}};
inline void sum_up(const LevelManifold& f, const LevelMatrix* at, const double (&share)[4], LevelMatrix& h) {
  for_each_number(f, [&](auto&& number) {
    real sum = share[0] * number(at[0]);
    for (int i = 1; i < 4; ++i) sum = fma(broadcast(share[i]), number(at[i]), sum);
    number(h) = sum;
  });
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

/// What whole steps of fourth order and halves of them would come to with ever shorter ones.
inline void extrapolate(int levels, const Amplitudes& whole, Amplitudes& halves) {
  real size2 = broadcast(0);
  for (int k = 0; k < levels; ++k) {
    halves.re[k] = fma(halves.re[k] - whole.re[k], broadcast(1.0 / 15), halves.re[k]);
    halves.im[k] = fma(halves.im[k] - whole.im[k], broadcast(1.0 / 15), halves.im[k]);
    size2 = fma(halves.re[k], halves.re[k], fma(halves.im[k], halves.im[k], size2));
  }
  const real unit = 1.0 / sqrt(size2);
  for (int k = 0; k < levels; ++k) {
    halves.re[k] = halves.re[k] * unit;
    halves.im[k] = halves.im[k] * unit;
  }
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
