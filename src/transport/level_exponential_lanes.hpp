#pragma once
// What a Hamiltonian of levels does to amplitudes, exponentials one after the other, for kernels only.
#include "transport/level_matrix_lanes.hpp"

namespace rabiline::RABILINE_ISA {

constexpr double largest_radius = 24;
/// exp(-i H) = J_0(R) + 2 sum over k of J_k(R) (-i)^k T_k(H/R), which holds and converges where no eigenvalue
/// is beyond R (H. Tal-Ezer and R. Kosloff, J. Chem. Phys. 81, 3967 (1984)).
class ChebyshevSeries {
  static constexpr int most_terms = 56;

 public:
  int terms = 1;
  real weight[most_terms];
  real twice;  // 2/R
  inline explicit ChebyshevSeries(real bound) {
    const real radius = max(broadcast(0.01), min(bound, broadcast(largest_radius)));
    last = floor(
        min(min(fma(radius, broadcast(40), broadcast(4)), fma(radius, broadcast(6), broadcast(8))),
            min(fma(radius, broadcast(2.6), broadcast(12)), fma(radius, broadcast(1.4), broadcast(21)))));
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
    // Couplings from one level stand one behind the other: what they bring to it is summed up apart.
    for (int c = 0; c < f.couplings;) {
      const int from = f.from[c];
      real sum_re = re[from], sum_im = im[from];
      for (; c < f.couplings && f.from[c] == from; ++c) {
        const int to = f.to[c];
        re[to] = fma(h.re[c], term.re[from], fnma(h.im[c], term.im[from], re[to]));
        im[to] = fma(h.re[c], term.im[from], fma(h.im[c], term.re[from], im[to]));
        sum_re = sum_re + fma(h.re[c], term.re[to], h.im[c] * term.im[to]);
        sum_im = sum_im + fnma(h.im[c], term.re[to], h.re[c] * term.im[to]);
      }
      re[from] = sum_re;
      im[from] = sum_im;
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
/// exp(-i H) a, right where no eigenvalue is beyond the series' radius.
inline void exponentiate(const LevelManifold& f, const LevelMatrix& h, const ChebyshevSeries& series,
                         Amplitudes& a) {
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
  exponentiate(f, h, ChebyshevSeries(radius_of(f, h)), a);
}
RABILINE_LANES void choose(int levels, mask m, const Amplitudes& yes, Amplitudes& a) {
  for (int k = 0; k < levels; ++k) {
    a.re[k] = select(m, yes.re[k], a.re[k]);
    a.im[k] = select(m, yes.im[k], a.im[k]);
  }
}

}  // namespace rabiline::RABILINE_ISA
