// Leapfrog steps in the gradient of |B| of a map: its cubic spline by the bare instructions of AVX-512, and
// by the function that the kernels call. A particle's sums go along rows of the table, which eight of them
// then exchange for lanes.
#include <immintrin.h>

#include "bench/limits.hpp"
#include "field/lane_maths.hpp"
#include "field/shaped_field.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

/// B and its slopes along x, y and z.
struct SplineSums {
  real of[4][4];  // [value, d/dx, d/dy, d/dz][component]
};

real transposed_pair(const real* rows, int c, int half) {
  const __m512d low =
      half == 0 ? _mm512_unpacklo_pd(rows[c], rows[c + 1]) : _mm512_unpackhi_pd(rows[c], rows[c + 1]);
  return low;
}
/// out[c][lane] = rows[lane][c].
void transpose(const real* rows, real* out) {
  real a[8], b[8];
  for (int i = 0; i < 8; i += 2) {
    a[i] = transposed_pair(rows, i, 0);
    a[i + 1] = transposed_pair(rows, i, 1);
  }
  for (int i = 0; i < 8; i += 4)
    for (int k = 0; k < 2; ++k) {
      b[i + k] = _mm512_shuffle_f64x2(a[i + k], a[i + 2 + k], 0x88);
      b[i + 2 + k] = _mm512_shuffle_f64x2(a[i + k], a[i + 2 + k], 0xDD);
    }
  for (int k = 0; k < 4; ++k) {
    out[k] = _mm512_shuffle_f64x2(b[k], b[4 + k], 0x88);
    out[k + 4] = _mm512_shuffle_f64x2(b[k], b[4 + k], 0xDD);
  }
}

RABILINE_LANES real both(const real* weights, int lane_number, int k) {
  return _mm512_mask_blend_pd(0xF0, _mm512_set1_pd(weights[k][lane_number]),
                              _mm512_set1_pd(weights[k + 1][lane_number]));
}

RABILINE_LANES SplineSums spline_sums(const MapShape& map, const real (&place)[3]) {
  real weight[3][4], slope[3][4];
  const long row = 4L * (map.nodes[2] + 2), stride[3] = {row * (map.nodes[1] + 2), row, 4};
  __m512i at = _mm512_setzero_si512();
  for (int a = 0; a < 3; ++a) {
    const real s = (place[a] - map.begin[a]) * map.scale[a];
    const real cell = _mm512_max_pd(
        _mm512_setzero_pd(), _mm512_min_pd(_mm512_roundscale_pd(s, 9), _mm512_set1_pd(map.nodes[a] - 2)));
    at = _mm512_add_epi64(at, _mm512_mullo_epi64(_mm512_cvtpd_epi64(cell), _mm512_set1_epi64(stride[a])));
    const real t = s - cell, u = 1.0 - t, t2 = t * t, u2 = u * u;
    weight[a][0] = (1.0 / 6) * u2 * u;
    weight[a][1] = 2.0 / 3 + t2 * (0.5 * t - 1.0);
    weight[a][2] = 2.0 / 3 + u2 * (0.5 * u - 1.0);
    weight[a][3] = (1.0 / 6) * t2 * t;
    slope[a][0] = -0.5 * u2;
    slope[a][1] = t * (1.5 * t - 2.0);
    slope[a][2] = u * (2.0 - 1.5 * u);
    slope[a][3] = 0.5 * t2;
  }
  alignas(64) long long first[8];
  _mm512_store_si512(first, at);
  real low[8], high[8];
  for (int p = 0; p < 8; ++p) {
    const double* c = map.table + first[p];
    real s0{}, s1{}, x0{}, x1{}, y0{}, y1{};
    for (int i = 0; i < 4; ++i) {
      real a0{}, a1{}, d0{}, d1{};
      for (int j = 0; j < 4; ++j) {
        const real u = _mm512_loadu_pd(c + i * stride[0] + j * stride[1]),
                   v = _mm512_loadu_pd(c + i * stride[0] + j * stride[1] + 8);
        a0 += u * weight[1][j][p];
        a1 += v * weight[1][j][p];
        d0 += u * slope[1][j][p];
        d1 += v * slope[1][j][p];
      }
      s0 += a0 * weight[0][i][p];
      s1 += a1 * weight[0][i][p];
      x0 += a0 * slope[0][i][p];
      x1 += a1 * slope[0][i][p];
      y0 += d0 * weight[0][i][p];
      y1 += d1 * weight[0][i][p];
    }
    const real w0 = both(weight[2], p, 0), w1 = both(weight[2], p, 2), d0 = both(slope[2], p, 0),
               d1 = both(slope[2], p, 2);
    const real s = s0 * w0 + s1 * w1, gx = x0 * w0 + x1 * w1, gy = y0 * w0 + y1 * w1, gz = s0 * d0 + s1 * d1;
    low[p] = real(_mm512_shuffle_f64x2(s, gx, 0x44)) + real(_mm512_shuffle_f64x2(s, gx, 0xEE));
    high[p] = real(_mm512_shuffle_f64x2(gy, gz, 0x44)) + real(_mm512_shuffle_f64x2(gy, gz, 0xEE));
  }
  SplineSums sums;
  transpose(low, sums.of[0]);
  transpose(high, sums.of[2]);
  for (int a = 1; a < 4; ++a)
    for (int m = 0; m < 3; ++m) sums.of[a][m] = sums.of[a][m] * map.scale[a - 1];
  return sums;
}

/// The gradient of |B|.
struct ByHand {
  const MapShape& map;
  RABILINE_LANES void operator()(const real (&place)[3], real (&pull)[3]) const {
    const SplineSums sums = spline_sums(map, place);
    const real* b = sums.of[0];
    const real over = 1.0 / sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
    for (int k = 0; k < 3; ++k)
      pull[k] = (b[0] * sums.of[k + 1][0] + b[1] * sums.of[k + 1][1] + b[2] * sums.of[k + 1][2]) * over;
  }
};
struct AsFlown {
  const ShapedTerm term;
  RABILINE_LANES void operator()(const real (&place)[3], real (&pull)[3]) const {
    FieldHere<real> here{};
    add_field<LaneMaths>(term, place[0], place[1], place[2], here);
    const real *b = here.field, over = 1.0 / sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
    for (int k = 0; k < 3; ++k)
      pull[k] = (b[0] * here.slope[k] + b[1] * here.slope[3 + k] + b[2] * here.slope[6 + k]) * over;
  }
};

/// Eight particles beside each other, from the map's begin to its end along y; where the first one ends.
template <class Pull>
double leapfrog(const MapShape& map, const Pull& pull_at, int steps, int packs) {
  constexpr double strength = -1e-6;
  const double length = (map.nodes[1] - 1) / map.scale[1], h = 0.75 * length / steps;
  double end = 0;
  for (int pack = 0; pack < packs; ++pack) {
    real place[3], velocity[3] = {real{}, broadcast(1), real{}};
    for (int a = 0; a < 3; ++a) place[a] = broadcast(map.begin[a] + 0.4 * (map.nodes[a] - 1) / map.scale[a]);
    place[1] = broadcast(map.begin[1] + length / 8);
    for (int i = 0; i < lane_count; ++i) set_lane(place[0], i, lane(place[0], i) + i * 1e-3 * length);
    for (int i = 0; i < steps; ++i) {
      real pull[3];
      for (int a = 0; a < 3; ++a) place[a] = place[a] + 0.5 * h * velocity[a];
      pull_at(place, pull);
      for (int a = 0; a < 3; ++a) {
        velocity[a] = velocity[a] + strength * h * pull[a];
        place[a] = place[a] + 0.5 * h * velocity[a];
      }
    }
    end = lane(place[0], 0);
  }
  return end;
}

}  // namespace
}  // namespace rabiline::RABILINE_ISA

namespace rabiline::bench {

using namespace rabiline::RABILINE_ISA;

double leapfrog_by_hand(const MapShape& map, int steps, int packs) {
  return leapfrog(map, ByHand{map}, steps, packs);
}
double leapfrog_as_flown(const MapShape& map, int steps, int packs) {
  return leapfrog(map, AsFlown{ShapedTerm(map)}, steps, packs);
}

}  // namespace rabiline::bench
