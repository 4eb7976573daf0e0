#pragma once
// A step of levels through a Hamiltonian that changes, without commutators (S. Blanes and P. Moan, Appl.
// Numer. Math. 56, 1519 (2006)), for kernels only.
#include "transport/level_exponential_lanes.hpp"

namespace rabiline::RABILINE_ISA {

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
constexpr double lobatto_weight[5] = {1.0 / 20, 49.0 / 180, 16.0 / 45, 49.0 / 180, 1.0 / 20};
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
/// Legendre's polynomials P_0 to P_4 at Gauss' points, and half of their integrals from -1 to there.
struct GaussPoints {
  static constexpr int count = 8;
  double weight[count] = {}, value[count][5] = {}, until[count][5] = {};
};
constexpr GaussPoints gauss_points() {
  constexpr double place[4] = {0.18343464249564980, 0.52553240991632899, 0.79666647741362674,
                               0.96028985649753623},
                   weight[4] = {0.36268378337836198, 0.31370664587788729, 0.22238103445337447,
                                0.10122853629037626};
  GaussPoints points;
  for (int i = 0; i < GaussPoints::count; ++i) {
    const double x = i < 4 ? -place[3 - i] : place[i - 4];
    double p[6] = {1, x};
    for (int n = 1; n < 5; ++n) p[n + 1] = ((2 * n + 1) * x * p[n] - n * p[n - 1]) / (n + 1);
    points.weight[i] = weight[i < 4 ? 3 - i : i - 4];
    for (int n = 0; n < 5; ++n) {
      points.value[i][n] = p[n];
      points.until[i][n] = n == 0 ? 0.5 * (x + 1) : 0.5 * (p[n + 1] - p[n - 1]) / (2 * n + 1);
    }
  }
  return points;
}
/// What a field turns and grows by in a step of the length h is known from where it ends. Rates at Lobatto's
/// points tell it as well as the field is smooth between them, which a map is not from cell to cell: those of
/// the inner points are changed until they do. The frame begins with the axes `from`.
inline void agree_with_end(const LevelAxes& from, real h, FollowedField (&field)[5]) {
  // Of n, moved by the shortest way, the tangent of half of the angle has the rate of the turn over 1 +
  // cosine.
  const FollowedField& end = field[4];
  const real half = 1.0 / (1.0 + end.cosine);
  real turn_1 = -dot(end.n, from.second()) * half, turn_2 = dot(end.n, from.first) * half,
       growth = end.signed_size - field[0].signed_size;
  for (int i = 0; i < 5; ++i) {
    const real time = broadcast(lobatto_weight[i]) * h, share = time / (1.0 + field[i].cosine);
    turn_1 = fnma(field[i].turn_1, share, turn_1);
    turn_2 = fnma(field[i].turn_2, share, turn_2);
    growth = fnma(field[i].size_rate, time, growth);
  }
  constexpr double inner = lobatto_weight[1] + lobatto_weight[2] + lobatto_weight[3];
  const real over = select(h > broadcast(0), 1.0 / (inner * h), broadcast(0));
  for (int i = 1; i < 4; ++i) {
    const real by = over * (1.0 + field[i].cosine);
    field[i].turn_1 = fma(turn_1, by, field[i].turn_1);
    field[i].turn_2 = fma(turn_2, by, field[i].turn_2);
    field[i].size_rate = fma(growth, over, field[i].size_rate);
  }
}
/// Lanes whose couplings are weak against what they couple.
inline mask are_weak(const LevelManifold& f, const LevelMatrix& h) {
  real strongest2 = broadcast(0), most = broadcast(0);
  for (int j = 0; j < f.couplings; ++j) {
    strongest2 = max(fma(h.re[j], h.re[j], h.im[j] * h.im[j]), strongest2);
    most = max(abs(h.diagonal[f.to[j]] - h.diagonal[f.from[j]]), most);
  }
  return 100.0 * strongest2 < most * most;
}
/// Takes the energies of a step out of it, for some lanes: amplitudes are exp(-i phase) times those whose H
/// has only couplings, V_kl exp(i (phase_k - phase_l)), of which the factors of P_0 to P_4 are left. To
/// `phase` what it is at the end.
[[gnu::noinline]] inline void take_energies_out(const LevelManifold& f, mask lanes, LevelMatrix* at,
                                                real* phase) {
  static constexpr GaussPoints points = gauss_points();
  const real zero = broadcast(0);
  const auto angle_at = [](int i, const real* energy) {
    real angle = broadcast(points.until[i][0]) * energy[0];
    for (int n = 1; n < 5; ++n) angle = fma(broadcast(points.until[i][n]), energy[n], angle);
    return angle;
  };
  // Of more couplings than levels phases are the differences of those of levels.
  const bool by_levels = f.couplings > f.levels;
  Phasor of_level[GaussPoints::count][most_levels];
  for (int k = 0; by_levels && k < f.levels; ++k) {
    real energy[5];
    for (int n = 0; n < 5; ++n) energy[n] = select(lanes, at[n].diagonal[k], zero);
    for (int i = 0; i < GaussPoints::count; ++i) of_level[i][k] = phasor(angle_at(i, energy));
  }
  for (int j = 0; j < f.couplings; ++j) {
    const int to = f.to[j], from = f.from[j];
    real gap[5], re[5], im[5], sum_re[5] = {}, sum_im[5] = {};
    for (int n = 0; n < 5; ++n) {
      gap[n] = select(lanes, at[n].diagonal[to] - at[n].diagonal[from], zero);
      re[n] = at[n].re[j];
      im[n] = at[n].im[j];
    }
    for (int i = 0; i < GaussPoints::count; ++i) {
      real here_re = zero, here_im = zero;
      for (int n = 0; n < 5; ++n) {
        here_re = fma(broadcast(points.value[i][n]), re[n], here_re);
        here_im = fma(broadcast(points.value[i][n]), im[n], here_im);
      }
      const Phasor p = by_levels ? of_level[i][to] * Phasor{of_level[i][from].c, -of_level[i][from].s}
                                 : phasor(angle_at(i, gap));
      const real turned_re = fnma(here_im, p.s, here_re * p.c), turned_im = fma(here_im, p.c, here_re * p.s);
      for (int n = 0; n < 5; ++n) {
        const real by = broadcast((n + 0.5) * points.weight[i] * points.value[i][n]);
        sum_re[n] = fma(by, turned_re, sum_re[n]);
        sum_im[n] = fma(by, turned_im, sum_im[n]);
      }
    }
    for (int n = 0; n < 5; ++n) {
      at[n].re[j] = select(lanes, sum_re[n], re[n]);
      at[n].im[j] = select(lanes, sum_im[n], im[n]);
    }
  }
  for (int k = 0; k < f.levels; ++k) phase[k] = select(lanes, at[0].diagonal[k], zero);
  for (int n = 0; n < 5; ++n)
    for (int k = 0; k < f.levels; ++k) at[n].diagonal[k] = select(lanes, zero, at[n].diagonal[k]);
}
/// What a step of a time-dependent H exponentiates one after the other, without commutators: shares of the
/// factors of P_0 to P_3. The first is of fourth order; the other of sixth, of the family of A. Alvermann and
/// H. Fehske, J. Comput. Phys. 230, 5930 (2011), the one that is off by little in all words of seventh order.
constexpr double fourth_order[2][4] = {{1.0 / 2, -1.0 / 3, 0, 0}, {1.0 / 2, 1.0 / 3, 0, 0}};
constexpr double sixth_order[5][4] = {
    {0.17, -0.15308164118973627, 0.11924492356920877, -0.07200630399291547},
    {0.3764769461984308, -0.13970258837190308, -0.13055251465555773, 0.21079496539264855},
    {-0.0929538923968616, 0, 0.022615182172697906, 0},
    {0.3764769461984308, 0.13970258837190308, -0.13055251465555773, -0.21079496539264855},
    {0.17, 0.15308164118973627, 0.11924492356920877, 0.07200630399291547}};
template <int count>
constexpr double largest_share(const double (&shares)[count][4], int power) {
  double most = 0;
  for (const auto& share : shares) {
    const double size = share[power] < 0 ? -share[power] : share[power];
    most = size > most ? size : most;
  }
  return most;
}
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

/// Of the angle that P_4 turns by: about what Gauss' two points would differ from four by.
constexpr double unseen_share = 0.375;
/// The same of couplings that are turned by energies taken out: of their P_4, which tells what P_5 and more
/// would.
constexpr double turned_share = 0.25;
/// What is of sixth order is off by (share x what the fourth is off by)^(3/2): seventh order against fifth,
/// on the safe side.
constexpr double sixth_share = 0.1;
/// Of the product of the angles of P_3 and P_4, whose commutator neither has: a 63rd, less by what bounds
/// of them are too large, and by what steps with turned couplings cancel.
constexpr double apart_share = 0.0003;
/// Of the angle of couplings' P_4 what is lost where it is no smaller than P_2, as of a field that is rough
/// from point to point; the less, the smaller: P_8 is what Lobatto's points do not see.
constexpr double rough_share = 0.25;
/// A step of the length h through H at Lobatto's points, whose matrices are used up, and what it may be off
/// by; false where it turns by too much. `take_out`: where couplings are weak, energies are taken out.
inline mask step_through(const LevelManifold& f, real h, bool take_out, LevelMatrix* at, Amplitudes& state,
                         real& error) {
  to_legendre(f, h, at);
  const real whole = radius_of(f, at[4]), second = coupling_of(f, at[2]), fourth = coupling_of(f, at[4]),
             falls = fourth / max(max(second, fourth), broadcast(tiny));
  const mask weak = take_out ? are_weak(f, at[0]) : mask{};
  real phase[most_levels], radius[5];
  if (any(weak)) take_energies_out(f, weak, at, phase);
  for (int i = 0; i < 5; ++i) radius[i] = radius_of(f, at[i]);
  const real unseen = max(whole, turned_share * radius[4]);
  mask good = ~mask{};
  const auto turn = [&](const auto& shares, Amplitudes& turned) {
    real bound = broadcast(0);
    for (int i = 0; i < 4; ++i) bound = fma(broadcast(largest_share(shares, i)), radius[i], bound);
    good = good & (bound < broadcast(largest_radius));
    const ChebyshevSeries series(bound);
    for (const auto& share : shares) {
      LevelMatrix exponent;
      sum_up(f, at, share, exponent);
      exponentiate(f, exponent, series, turned);
    }
  };
  Amplitudes rough = state;
  turn(fourth_order, rough);
  turn(sixth_order, state);
  // Both alike leave P_4 out, and all of what is narrow between the points.
  const real off = sixth_share * fma(unseen, broadcast(unseen_share), difference(f.levels, rough, state));
  error = fma(off, sqrt(off), apart_share * radius[3] * radius[4]);
  error = fma(rough_share * fourth, falls * falls, error);
  if (any(weak))
    for (int k = 0; k < f.levels; ++k) turn_back(phase[k], k, state);
  return good;
}

}  // namespace rabiline::RABILINE_ISA
