#pragma once
// Vector arithmetic of the kernels. A kernel source is compiled once per instruction set
// (cmake/kernels.cmake), and all of it lives in a namespace named after the instruction set: nothing with
// external linkage is shared between the copies, and no std template is used, so the linker can never pick
// code that the processor cannot run.
//
// Every function gives the same bits on every instruction set: the operations are IEEE add, multiply, divide,
// square root and fused multiply-add, in the order written (-ffp-contract=off), without approximate
// reciprocals. Only the sign and the payload of a NaN are left open.
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#if !defined(RABILINE_ISA)
#define RABILINE_ISA isa_baseline
#define RABILINE_LANE_COUNT 2
#endif
#if RABILINE_LANE_COUNT == 8 && !(defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__))
#error "eight lanes need -mavx512f -mavx512dq -mavx512vl"
#elif RABILINE_LANE_COUNT == 4 && !(defined(__AVX2__) && defined(__FMA__))
#error "four lanes need -mavx2 -mfma"
#endif
#define RABILINE_LANES [[gnu::always_inline]] inline

namespace rabiline::RABILINE_ISA {

constexpr int lane_count = RABILINE_LANE_COUNT;

using real = double __attribute__((vector_size(8 * lane_count)));
using words = unsigned long long __attribute__((vector_size(8 * lane_count)));
/// What comparing two reals or two words gives: a lane is all ones or zero. Combine with & | ~.
using mask = decltype(real{} < real{});

// ---- moving data ----

/// x - 0 keeps the sign of zero, 0 + x would not.
RABILINE_LANES real broadcast(double x) { return x - real{}; }
RABILINE_LANES words broadcast_word(unsigned long long x) { return x + words{}; }

RABILINE_LANES words bit_pattern(real x) { return reinterpret_cast<words>(x); }
RABILINE_LANES real from_bits(words x) { return reinterpret_cast<real>(x); }

// Columns are aligned to 64 bytes and padded to whole vectors. may_alias: words are also read from columns of
// std::uint64_t, which need not be unsigned long long.
using real_in_memory [[gnu::may_alias]] = real;
using words_in_memory [[gnu::may_alias]] = words;
RABILINE_LANES real load(const double* p) { return *reinterpret_cast<const real_in_memory*>(p); }
RABILINE_LANES words load(const unsigned long long* p) {
  return *reinterpret_cast<const words_in_memory*>(p);
}
RABILINE_LANES words load(const unsigned long* p) { return *reinterpret_cast<const words_in_memory*>(p); }
/// The same, aligned to nothing more than themselves.
using real_anywhere [[gnu::aligned(8), gnu::may_alias]] = real;  // clang overlooks them behind the type
using words_anywhere [[gnu::aligned(8), gnu::may_alias]] = words;
RABILINE_LANES real load_anywhere(const double* p) { return *reinterpret_cast<const real_anywhere*>(p); }
RABILINE_LANES words load_anywhere(const unsigned long* p) {
  return *reinterpret_cast<const words_anywhere*>(p);
}
RABILINE_LANES void store_anywhere(unsigned long* p, words x) { *reinterpret_cast<words_anywhere*>(p) = x; }
/// Single-precision numbers, aligned to nothing more than themselves; conversion is exact.
RABILINE_LANES real load(const float* p) {
  using floats [[gnu::aligned(4), gnu::may_alias]] = float __attribute__((vector_size(4 * lane_count)));
  return __builtin_convertvector(*reinterpret_cast<const floats*>(p), real);
}
RABILINE_LANES void store(double* p, real x) { *reinterpret_cast<real_in_memory*>(p) = x; }
RABILINE_LANES void store(unsigned long long* p, words x) { *reinterpret_cast<words_in_memory*>(p) = x; }
RABILINE_LANES void store(unsigned long* p, words x) { *reinterpret_cast<words_in_memory*>(p) = x; }

RABILINE_LANES double lane(real x, int i) { return x[i]; }
RABILINE_LANES unsigned long long lane(words x, int i) { return x[i]; }
RABILINE_LANES void set_lane(real& x, int i, double value) { x[i] = value; }
RABILINE_LANES void set_lane(words& x, int i, unsigned long long value) { x[i] = value; }

/// 0, 1, 2, ...: the number of each lane.
RABILINE_LANES words lane_numbers() {
  words n{};
  for (int i = 0; i < lane_count; ++i) n[i] = static_cast<unsigned long long>(i);
  return n;
}

// ---- what differs between instruction sets ----

/// fma: a b + c and fnma: c - a b, rounded once. floor: |x| < 2^51. bits_of: one bit a lane.
/// product_of_low_words: the 64-bit product of the low halves of two words. high_word: the upper half moved
/// down; what is left above it is unspecified. joined: the low half of `high` above the low half of `low`.
/// interleave: a0, b0, a1, b1, ... pack: the chosen lanes one after the other, and how many they are; what
/// else is written behind them, up to whole lanes, is unspecified.
// The maskz forms with every lane chosen are the plain instructions; g++ 12 warns of an uninitialised operand
// inside the plain forms.
#if RABILINE_LANE_COUNT == 8
RABILINE_LANES real fma(real a, real b, real c) { return _mm512_fmadd_pd(a, b, c); }
RABILINE_LANES real fnma(real a, real b, real c) { return _mm512_fnmadd_pd(a, b, c); }
RABILINE_LANES real sqrt(real x) { return _mm512_maskz_sqrt_pd(0xFF, x); }
RABILINE_LANES real floor(real x) {
  return _mm512_maskz_roundscale_pd(0xFF, x, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
}
RABILINE_LANES unsigned bits_of(mask m) { return _mm512_movepi64_mask(reinterpret_cast<__m512i>(m)); }
RABILINE_LANES words product_of_low_words(words a, words b) {
  return reinterpret_cast<words>(
      _mm512_maskz_mul_epu32(0xFF, reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b)));
}
RABILINE_LANES words high_word(words x) {
  return reinterpret_cast<words>(
      _mm512_maskz_shuffle_epi32(0xFFFF, reinterpret_cast<__m512i>(x), static_cast<_MM_PERM_ENUM>(0xF5)));
}
RABILINE_LANES words joined(words high, words low) {
  return reinterpret_cast<words>(_mm512_mask_shuffle_epi32(reinterpret_cast<__m512i>(low), 0xAAAA,
                                                           reinterpret_cast<__m512i>(high),
                                                           static_cast<_MM_PERM_ENUM>(0xA0)));
}
RABILINE_LANES void interleave(real a, real b, real& low, real& high) {
  low = __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11);
  high = __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
}
RABILINE_LANES int pack(words x, mask chosen, unsigned long* to) {
  const unsigned bits = bits_of(chosen);
  _mm512_storeu_si512(to,
                      _mm512_maskz_compress_epi64(static_cast<__mmask8>(bits), reinterpret_cast<__m512i>(x)));
  return __builtin_popcount(bits);
}
#elif RABILINE_LANE_COUNT == 4
RABILINE_LANES real fma(real a, real b, real c) { return _mm256_fmadd_pd(a, b, c); }
RABILINE_LANES real fnma(real a, real b, real c) { return _mm256_fnmadd_pd(a, b, c); }
RABILINE_LANES real sqrt(real x) { return _mm256_sqrt_pd(x); }
RABILINE_LANES real floor(real x) { return _mm256_floor_pd(x); }
RABILINE_LANES unsigned bits_of(mask m) {
  return static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<__m256d>(m)));
}
RABILINE_LANES words product_of_low_words(words a, words b) {
  return reinterpret_cast<words>(
      _mm256_mul_epu32(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
}
RABILINE_LANES words high_word(words x) {
  return reinterpret_cast<words>(_mm256_shuffle_epi32(reinterpret_cast<__m256i>(x), 0xF5));
}
RABILINE_LANES words joined(words high, words low) {
  const __m256i above = _mm256_shuffle_epi32(reinterpret_cast<__m256i>(high), 0xA0);
  return reinterpret_cast<words>(_mm256_blend_epi32(reinterpret_cast<__m256i>(low), above, 0xAA));
}
RABILINE_LANES void interleave(real a, real b, real& low, real& high) {
  low = __builtin_shufflevector(a, b, 0, 4, 1, 5);
  high = __builtin_shufflevector(a, b, 2, 6, 3, 7);
}
#else
// Without the instruction __builtin_fma is libm's fma, a plain C function and correctly rounded. Two calls of
// it wherever one is written would be most of the program, and of the time to compile it.
#if defined(__x86_64__) && RABILINE_LANE_COUNT == 2
[[gnu::noinline, gnu::const]] inline real fma(real a, real b, real c) {
#else
RABILINE_LANES real fma(real a, real b, real c) {
#endif
  real r{};
  for (int i = 0; i < lane_count; ++i) r[i] = __builtin_fma(a[i], b[i], c[i]);
  return r;
}
RABILINE_LANES real fnma(real a, real b, real c) { return fma(-a, b, c); }
RABILINE_LANES real sqrt(real x) {
#if RABILINE_LANE_COUNT == 2 && defined(__SSE2__)
  return _mm_sqrt_pd(x);
#else
  real r{};
  for (int i = 0; i < lane_count; ++i) r[i] = __builtin_sqrt(x[i]);
  return r;
#endif
}
RABILINE_LANES real floor(real x) {
  const real nearest = (x + 0x1.8p52) - 0x1.8p52;
  return nearest > x ? nearest - 1.0 : nearest;
}
RABILINE_LANES unsigned bits_of(mask m) {
#if RABILINE_LANE_COUNT == 2 && defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_pd(reinterpret_cast<__m128d>(m)));
#else
  unsigned bits = 0;
  for (int i = 0; i < lane_count; ++i) bits |= (m[i] != 0 ? 1U : 0U) << i;
  return bits;
#endif
}
RABILINE_LANES words product_of_low_words(words a, words b) {
#if RABILINE_LANE_COUNT == 2 && defined(__SSE2__)
  return reinterpret_cast<words>(_mm_mul_epu32(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#else
  return (a & 0xFFFFFFFFULL) * (b & 0xFFFFFFFFULL);
#endif
}
RABILINE_LANES words high_word(words x) { return x >> 32; }
RABILINE_LANES words joined(words high, words low) { return high << 32 | (low & 0xFFFFFFFFULL); }
RABILINE_LANES void interleave(real a, real b, real& low, real& high) {
  for (int i = 0; i < lane_count; ++i) {
    low[i] = i % 2 == 0 ? a[i / 2] : b[i / 2];
    high[i] = i % 2 == 0 ? a[(lane_count + i) / 2] : b[(lane_count + i) / 2];
  }
}
#endif
#if RABILINE_LANE_COUNT != 8
RABILINE_LANES int pack(words x, mask chosen, unsigned long* to) {
  int count = 0;
  for (int i = 0; i < lane_count; ++i) {
    to[count] = x[i];
    count += chosen[i] != 0 ? 1 : 0;
  }
  return count;
}
#endif

// ---- choosing ----

RABILINE_LANES real select(mask m, real a, real b) { return m ? a : b; }
RABILINE_LANES words select(mask m, words a, words b) { return m ? a : b; }
RABILINE_LANES bool any(mask m) { return bits_of(m) != 0; }
RABILINE_LANES bool all(mask m) { return bits_of(m) == (1U << lane_count) - 1; }
/// The first n lanes: what a partly filled vector counts.
RABILINE_LANES mask first_lanes(int n) { return reinterpret_cast<mask>(lane_numbers()) < n; }

RABILINE_LANES real abs(real x) { return from_bits(bit_pattern(x) & 0x7FFFFFFFFFFFFFFFULL); }
/// The second argument where either is a NaN or both are zero.
RABILINE_LANES real min(real a, real b) { return a < b ? a : b; }
RABILINE_LANES real max(real a, real b) { return a > b ? a : b; }

// ---- functions ----

/// Adding it leaves no room for a fraction: the integer nearest to x stands in the low bits of x +
/// round_shift.
constexpr double round_shift = 0x1.8p52;

/// Ties go to even. |x| < 2^51.
RABILINE_LANES real round_to_nearest(real x) { return (x + round_shift) - round_shift; }

/// The polynomial with these coefficients, the highest power first.
template <int n>
RABILINE_LANES real polynomial(real z, const double (&coefficients)[n]) {
  real p = broadcast(coefficients[0]);
#pragma GCC unroll 16
  for (int i = 1; i < n; ++i) p = fma(p, z, broadcast(coefficients[i]));
  return p;
}

/// Sine and cosine of x in radians, |x| <= 1e9: absolute error below 2e-16, and neither exceeds 1.
/// Reduced by multiples of pi/2 in two pieces. The first fma is exact: both x and the product are multiples
/// of the last bit of pi_half_high there, and the difference is below 1. Polynomials: fdlibm, k_sin.c and
/// k_cos.c.
RABILINE_LANES void sincos(real x, real& s, real& c) {
  constexpr double two_over_pi = 0x1.45f306dc9c883p-1;
  constexpr double pi_half_high = 0x1.921fb54442d18p+0;
  constexpr double pi_half_low = 6.123233995736766e-17;
  constexpr double sine[] = {1.58969099521155010221e-10, -2.50507602534068634195e-08,
                             2.75573137070700676789e-06, -1.98412698298579493134e-04,
                             8.33333333332248946124e-03, -1.66666666666666324348e-01};
  constexpr double cosine[] = {-1.13596475577881948265e-11, 2.08757232129817482790e-09,
                               -2.75573143513906633035e-07, 2.48015872894767294178e-05,
                               -1.38888888888741095749e-03, 4.16666666666666019037e-02};
  const real shifted = fma(x, broadcast(two_over_pi), broadcast(round_shift));
  const words quadrant = bit_pattern(shifted);
  const real turns = shifted - round_shift;
  real r = fnma(turns, broadcast(pi_half_high), x);
  r = fnma(turns, broadcast(pi_half_low), r);
  const real z = r * r;
  const real sine_of_r = fma(r * z, polynomial(z, sine), r);
  const real cosine_of_r = fma(z * z, polynomial(z, cosine), fnma(z, broadcast(0.5), broadcast(1.0)));
  const mask odd = (quadrant & 1ULL) != 0ULL;
  const words sign_of_sine = (quadrant & 2ULL) << 62;
  const words sign_of_cosine = ((quadrant + 1ULL) & 2ULL) << 62;
  s = from_bits(bit_pattern(select(odd, cosine_of_r, sine_of_r)) ^ sign_of_sine);
  c = from_bits(bit_pattern(select(odd, sine_of_r, cosine_of_r)) ^ sign_of_cosine);
}

/// The square of the sine of x in radians, |x| <= 1e9: absolute error below 6e-16, between 0 and 1, as a
/// probability must be. Its period is pi, so there are no quadrants to tell apart. The polynomial is
/// (sin(r)/r - 1)/r^2 interpolated in r^2 at the Chebyshev points of |r| <= pi/2, its last coefficient
/// lowered by 5e-20: then rounding never takes the result above 1 (tried for every r within 6e-8 of pi/2).
RABILINE_LANES real sin_squared(real x) {
  constexpr double one_over_pi = 0x1.45f306dc9c883p-2;
  constexpr double pi_high = 0x1.921fb54442d18p+1;
  constexpr double pi_low = 1.2246467991473532e-16;
  constexpr double sine[] = {2.7314e-15,
                             -7.64397029679267883e-13,
                             1.60589773124639035e-10,
                             -2.50521076169961788e-08,
                             2.75573192191632342e-06,
                             -1.98412698412549741e-04,
                             8.33333333333331587e-03,
                             -1.66666666666666657e-01};
  const real half_turns = fma(x, broadcast(one_over_pi), broadcast(round_shift)) - round_shift;
  real r = fnma(half_turns, broadcast(pi_high), x);
  r = fnma(half_turns, broadcast(pi_low), r);
  const real z = r * r;
  const real s = fma(r * z, polynomial(z, sine), r);
  return s * s;
}

/// Natural logarithm of a positive normal number: relative error below 2.2e-16.
/// x = 2^k (1 + f) with 1 + f between sqrt(1/2) and sqrt(2), as in fdlibm's e_log.c, whose polynomial this
/// is.
RABILINE_LANES real log(real x) {
  constexpr unsigned long long sqrt_half = 0x3FE6A09E667F3BCDULL;
  constexpr unsigned long long one = 0x3FF0000000000000ULL;
  constexpr unsigned long long mantissa = 0x000FFFFFFFFFFFFFULL;
  constexpr double ln2 = 0x1.62e42fefa39efp-1;
  constexpr double series[] = {1.479819860511658591e-01, 1.531383769920937332e-01, 1.818357216161805012e-01,
                               2.222219843214978396e-01, 2.857142874366239149e-01, 3.999999999940941908e-01,
                               6.666666666666735130e-01};
  const words scaled = bit_pattern(x) + (one - sqrt_half);
  // The biased exponent as the last bits of a number with exponent 52, whose value is then known exactly.
  const real k = from_bits(scaled >> 52 | 0x4330000000000000ULL) - (0x1p52 + 1023.0);
  const real f = from_bits((scaled & mantissa) + sqrt_half) - 1.0;
  const real s = f / (f + 2.0);
  const real z = s * s;
  const real log_of_mantissa = fnma(s, fnma(z, polynomial(z, series), f), f);
  return fma(k, broadcast(ln2), log_of_mantissa);
}

/// e^x for -700 <= x <= 700, beyond as at the ends: relative error below 4e-16. x = k ln 2 + r, |r| <= 0.35;
/// the series of e^r.
RABILINE_LANES real exp(real x) {
  constexpr double log2_e = 0x1.71547652b82fep+0;
  constexpr double ln2_high = 0x1.62e42fefa39efp-1, ln2_low = 0x1.abc9e3b39803fp-56;
  constexpr double series[] = {
      1.0 / 6227020800, 1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320, 1.0 / 5040,
      1.0 / 720,        1.0 / 120,       1.0 / 24,       1.0 / 6,       0.5,          1.0,         1.0};
  x = max(broadcast(-700), min(broadcast(700), x));
  const real shifted = fma(x, broadcast(log2_e), broadcast(round_shift)), k = shifted - round_shift;
  const real r = fnma(k, broadcast(ln2_low), fnma(k, broadcast(ln2_high), x));
  return polynomial(r, series) * from_bits((bit_pattern(shifted) + 1023ULL) << 52);
}

/// The angle between -pi/2 and pi/2 whose tangent is x: absolute error below 4e-16. Taken to |r| <= tan(pi/8)
/// by atan(x) = pi/2 - atan(1/x) and atan(x) = pi/4 + atan((x - 1)/(x + 1)); polynomial: fdlibm, s_atan.c.
RABILINE_LANES real atan(real x) {
  constexpr double quarter_pi = 0x1.921fb54442d18p-1;
  constexpr double series[] = {
      1.62858201153657823623e-02,  -3.65315727442169155270e-02, 4.97687799461593236017e-02,
      -5.83357013379057348645e-02, 6.66107313738753120669e-02,  -7.69187620504482999495e-02,
      9.09088713343650656196e-02,  -1.11111104054623557880e-01, 1.42857142725034663711e-01,
      -1.99999999998764832476e-01, 3.33333333333329318027e-01};
  const real size = abs(x);
  const mask steep = size > broadcast(1);
  const real low = select(steep, 1.0 / size, size);
  const mask upper = low > broadcast(0.41421356237309503);
  const real r = select(upper, (low - 1.0) / (low + 1.0), low);
  const real z = r * r;
  const real of_r = fnma(r * z, polynomial(z, series), r);
  const real of_low = select(upper, quarter_pi + of_r, of_r);
  return from_bits(bit_pattern(select(steep, 2.0 * quarter_pi - of_low, of_low)) |
                   (bit_pattern(x) & 0x8000000000000000ULL));
}

/// For turning a vector v by the rotation vector o with q = |o|^2 <= 1 (a = |o|):
/// v + S (o x v) + C (o x (o x v)), S = sin(a)/a, C = (1 - cos a)/a^2. Absolute error below 1.2e-16 in S,
/// 6e-17 in C. Interpolated at the Chebyshev points of 0 <= q <= 1 with S(0) and C(0) kept exact.
RABILINE_LANES void rotation_coefficients(real q, real& S, real& C) {
  constexpr double sine[] = {
      -7.54937170418124304e-13, 1.60577019225797864e-10, -2.50520992449141141e-08, 2.75573191920112204e-06,
      -1.98412698412165663e-04, 8.33333333333330026e-03, -1.66666666666666657e-01, 1.0};
  constexpr double cosine[] = {1.13282363744602616e-11,
                               -2.08751569373936082e-09,
                               2.75573109351407262e-07,
                               -2.48015872821697726e-05,
                               1.38888888888722491e-03,
                               -4.16666666666666435e-02,
                               0.5};
  S = polynomial(q, sine);
  C = polynomial(q, cosine);
}

}  // namespace rabiline::RABILINE_ISA
