#include <immintrin.h>

#include "bench/limits.hpp"
#include "transport/vector_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

using bench::FlipSums;
using bench::RabiLine;

/// 1/x and 1/sqrt(x) to rounding, by two Newton steps from 14 bits.
RABILINE_LANES real reciprocal(real x) {
  real y = _mm512_maskz_rcp14_pd(0xFF, x);
  y = fma(y, fnma(x, y, broadcast(1)), y);
  return fma(y, fnma(x, y, broadcast(1)), y);
}
RABILINE_LANES real reciprocal_root(real x) {
  real y = _mm512_maskz_rsqrt14_pd(0xFF, x);
  const real half = x * 0.5;
  y = y * fnma(half * y, y, broadcast(1.5));
  return y * fnma(half * y, y, broadcast(1.5));
}

/// cos(2 pi u) for 0 < u < 1 as 2 sin^2(pi (u - 1/2)) - 1: no reduction, no quadrants.
RABILINE_LANES real cosine_of_turns(real u) {
  constexpr double sine[] = {2.7314e-15,
                             -7.64397029679267883e-13,
                             1.60589773124639035e-10,
                             -2.50521076169961788e-08,
                             2.75573192191632342e-06,
                             -1.98412698412549741e-04,
                             8.33333333333331587e-03,
                             -1.66666666666666657e-01};
  const real r = (u - 0.5) * 3.14159265358979324, z = r * r;
  const real s = fma(r * z, polynomial(z, sine), r);
  return fma(s + s, s, broadcast(-1));
}

struct Draw {
  const Emission& e;
  RABILINE_LANES void operator()(words number, unsigned use, real& u0, real& u1) const {
    uniforms(number, e.key.seed, use, 0, e.key.stream, u0, u1);
  }
};
RABILINE_LANES words numbers_from(std::uint64_t first) {
  return lane_numbers() + static_cast<unsigned long long>(first);
}

/// Each particle draws for itself: of the two normal numbers that come of it the program gives one to it and
/// the other to the particle beside it.
struct NormalSlowness {
  Draw draw;
  RABILINE_LANES real slowness(real radius, real cosine) const {
    return reciprocal(fma(radius * cosine, broadcast(draw.e.speed.sigma), broadcast(draw.e.speed.centre)));
  }
  RABILINE_LANES static real radius_of(real u) {
    const real minus_two_log = -2.0 * log(u);
    return minus_two_log * reciprocal_root(minus_two_log);
  }
  RABILINE_LANES real operator()(std::uint64_t first) const {
    real u0, u1;
    const words particle = numbers_from(first);
    draw(particle >> 1, purpose::speeds_of_two, u0, u1);
    // The sine of the odd ones is the cosine a quarter of a turn before.
    const real quarter = select((particle & 1ULL) != 0ULL, broadcast(0.25), broadcast(0)),
               turns = u1 - quarter;
    return slowness(radius_of(u0), cosine_of_turns(select(turns < broadcast(0), turns + 1.0, turns)));
  }
  /// Of sixteen particles, the even ones and the odd ones.
  RABILINE_LANES void of_two(std::uint64_t first, real& even, real& odd) const {
    real u0, u1;
    draw(numbers_from(first / 2), purpose::speeds_of_two, u0, u1);
    const real radius = radius_of(u0), turns = u1 - 0.25;
    even = slowness(radius, cosine_of_turns(u1));
    odd = slowness(radius, cosine_of_turns(select(turns < broadcast(0), turns + 1.0, turns)));
  }
};

/// v^2/a^2 is the sum of two exponential variables.
struct FluxWeightedSlowness {
  Draw draw;
  RABILINE_LANES real operator()(std::uint64_t first) const {
    real u0, u1;
    draw(numbers_from(first), purpose::speed, u0, u1);
    return reciprocal_root(-log(u0 * u1)) * (1 / draw.e.speed.mean);
  }
};

struct Accumulator {
  real p = real{}, p_squared = real{};
  RABILINE_LANES void add(real x) {
    p = p + x;
    p_squared = fma(x, x, p_squared);
  }
  void flush(FlipSums& sums) const {
    for (int i = 0; i < lane_count; ++i) {
      sums.p += lane(p, i);
      sums.p_squared += lane(p_squared, i);
    }
  }
};

RABILINE_LANES real flip(const RabiLine& line, real slowness) {
  return line.most * sin_squared(line.half_turn_per_slowness * slowness);
}

/// A place in the table of a period, between two of its rows.
struct PeriodRow {
  const double* columns;
  __m512i at;
  real share;
  PeriodRow(const bench::PeriodTable& table, real angle) : columns(table.rows.data()) {
    constexpr int phases = bench::PeriodTable::phases;
    const real place = angle * (phases / 6.283185307179586), row = floor(place);
    share = place - row;
    const __m512i number = _mm512_and_epi64(_mm512_cvttpd_epi64(row), _mm512_set1_epi64(phases - 1));
    at = _mm512_slli_epi64(number, 4);
  }
  real operator[](int number) const {
    return fma(share, real(_mm512_i64gather_pd(at, columns + 2 * number + 1, 8)),
               real(_mm512_i64gather_pd(at, columns + 2 * number, 8)));
  }
};
/// |d_1 u_1* exp(-i a) + d_2 u_2* exp(i a)|^2.
RABILINE_LANES real flip(const PeriodRow& in, const PeriodRow& out, real angle) {
  const auto passed = [&](int begin, int end, real& re, real& im) {
    const real u_re = in[begin], u_im = in[begin + 1], d_re = out[end], d_im = out[end + 1];
    re = fma(d_re, u_re, d_im * u_im);
    im = fnma(d_re, u_im, d_im * u_re);
  };
  real re_1, im_1, re_2, im_2, s, c;
  passed(0, 4, re_1, im_1);
  passed(2, 6, re_2, im_2);
  sincos(angle, s, c);
  const real re = fma(c, re_1 + re_2, s * (im_1 - im_2)), im = fma(c, im_1 + im_2, s * (re_2 - re_1));
  return fma(re, re, im * im);
}

/// Two packs in flight hide each other's latencies.
template <class Slowness>
FlipSums beam(const Slowness& slowness, const RabiLine& line, std::uint64_t particles) {
  Accumulator a, b;
  for (std::uint64_t i = 0; i < particles; i += 2 * lane_count) {
    a.add(flip(line, slowness(i)));
    b.add(flip(line, slowness(i + lane_count)));
  }
  FlipSums sums;
  a.flush(sums);
  b.flush(sums);
  return sums;
}

}  // namespace
}  // namespace rabiline::RABILINE_ISA

namespace rabiline::bench {

using namespace rabiline::RABILINE_ISA;

FlipSums normal_beam(const Emission& e, const RabiLine& line, std::uint64_t particles) {
  return beam(NormalSlowness{{e}}, line, particles);
}

FlipSums paired_normal_beam(const Emission& e, const RabiLine& line, std::uint64_t particles) {
  const NormalSlowness draw{{e}};
  Accumulator a, b;
  for (std::uint64_t i = 0; i < particles; i += 2 * lane_count) {
    real even, odd;
    draw.of_two(i, even, odd);
    a.add(flip(line, even));
    b.add(flip(line, odd));
  }
  FlipSums sums;
  a.flush(sums);
  b.flush(sums);
  return sums;
}

FlipSums flux_weighted_beam(const Emission& e, const RabiLine& line, std::uint64_t particles) {
  return beam(FluxWeightedSlowness{{e}}, line, particles);
}

FlipSums oscillating_beam(const Emission& e, const PeriodTable& table, const DriveTerm& drive, double begin,
                          double end, std::uint64_t particles) {
  const NormalSlowness draw{{e}};
  Accumulator sum;
  for (std::uint64_t i = 0; i < particles; i += lane_count) {
    const real slowness = draw(i),
               in = fma(broadcast(table.omega * begin), slowness,
                        oscillator_phase(drive, e.key, numbers_from(i))),
               stay = slowness * (end - begin);
    sum.add(flip(PeriodRow(table, in), PeriodRow(table, fma(broadcast(table.omega), stay, in)),
                 table.half_rate * stay));
  }
  FlipSums sums;
  sum.flush(sums);
  return sums;
}

void scan_of_normal_beam(const Emission& e, const std::vector<RabiLine>& lines, std::uint64_t particles,
                         FlipSums* sums) {
  constexpr std::uint64_t block = 2048;
  alignas(64) double slowness[block];
  const NormalSlowness draw{{e}};
  for (std::uint64_t first = 0; first < particles; first += block) {
    for (std::uint64_t i = 0; i < block; i += lane_count) store(slowness + i, draw(first + i));
    for (const RabiLine& line : lines) {
      Accumulator a, b;
      for (std::uint64_t i = 0; i < block; i += 2 * lane_count) {
        a.add(flip(line, load(slowness + i)));
        b.add(flip(line, load(slowness + i + lane_count)));
      }
      FlipSums& sum = sums[&line - lines.data()];
      a.flush(sum);
      b.flush(sum);
    }
  }
}

}  // namespace rabiline::bench
