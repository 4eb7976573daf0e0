#include "core/portable_math.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#define RABILINE_ISA isa_scalar
#define RABILINE_LANE_COUNT 1
#include "core/lanes.hpp"

namespace rabiline::portable {
namespace {

using std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

// A fused multiply-add rounds in the same way as an instruction and as a function of the library, only
// faster.
#if defined(__x86_64__)
const bool has_fma = __builtin_cpu_supports("fma") != 0;
template <class Function>
[[gnu::target("fma"), gnu::noinline]] auto with_instruction(double x) {
  return Function::of(x);
}
template <class Function>
auto call(double x) {
  return has_fma ? with_instruction<Function>(x) : Function::of(x);
}
#else
template <class Function>
auto call(double x) {
  return Function::of(x);
}
#endif

template <isa_scalar::real (*function)(isa_scalar::real)>
struct OneLane {
  RABILINE_LANES static double of(double x) {
    return isa_scalar::lane(function(isa_scalar::broadcast(x)), 0);
  }
};
template <isa_scalar::real (*function)(isa_scalar::real)>
double of_one_lane(double x) {
  return call<OneLane<function>>(x);
}

struct SineAndCosine {
  double sine, cosine;
};
struct OfAngle {
  RABILINE_LANES static SineAndCosine of(double x) {
    isa_scalar::real s, c;
    isa_scalar::sincos(isa_scalar::broadcast(x), s, c);
    return {isa_scalar::lane(s, 0), isa_scalar::lane(c, 0)};
  }
};
SineAndCosine sincos(double x) { return call<OfAngle>(x); }

}  // namespace

double sin(double x) { return sincos(x).sine; }
double cos(double x) { return sincos(x).cosine; }
double tan(double x) {
  const SineAndCosine of_x = sincos(x);
  return of_x.sine / of_x.cosine;
}

double atan(double x) { return of_one_lane<isa_scalar::atan>(x); }
double asin(double x) { return atan2(x, std::sqrt((1 - x) * (1 + x))); }
double acos(double x) { return 2 * atan2(std::sqrt(1 - x), std::sqrt(1 + x)); }
double atan2(double y, double x) {
  const double steepness = y == 0 ? 0 : atan(std::abs(y) / std::abs(x));
  return std::copysign(std::signbit(x) ? pi - steepness : steepness, y);
}

// The lanes' exponential ends at +-700.
double exp(double x) {
  if (std::abs(x) <= 700) return of_one_lane<isa_scalar::exp>(x);
  if (std::isnan(x)) return x;
  if (std::abs(x) > 1400) return x > 0 ? infinity : 0;
  const double half = exp(x / 2);
  return half * half;
}

// The lanes' logarithm is one of positive normal numbers.
double log(double x) {
  constexpr double smallest = std::numeric_limits<double>::min();
  if (x >= smallest && x < infinity) return of_one_lane<isa_scalar::log>(x);
  if (x > 0 && x < smallest) return log(x * 0x1p54) - 54 * std::numbers::ln2;
  return x == 0 ? -infinity : x > 0 ? x : std::numeric_limits<double>::quiet_NaN();
}

// asinh x = log(1 + u) with u = x + x^2/(1 + sqrt(1 + x^2)) for x > 0. Where 1 + u is rounded, so is log(1 +
// u)/u by the same share: Kahan's way to it.
double asinh(double x) {
  const double size = std::abs(x), u = size + size * size / (1 + hypot(1, size)), rounded = 1 + u;
  return std::copysign(rounded == 1 ? u : log(rounded) * (u / (rounded - 1)), x);
}

double pow(double x, double y) { return exp(y * log(x)); }
double pow(double x, int n) {
  double power = 1;
  for (int left = std::abs(n); left > 0; left /= 2, x *= x)
    if (left % 2 != 0) power *= x;
  return n < 0 ? 1 / power : power;
}

// Up to 2 by erf x = 2 x/sqrt(pi) exp(-x^2) sum over n of (2 x^2)^n / (1 3 ... (2n+1)), whose terms are
// positive, beyond by 1 - erf x = exp(-x^2)/sqrt(pi) / (x + (1/2)/(x + 1/(x + (3/2)/(x + ...)))) (Abramowitz
// and Stegun 7.1.6, 7.1.14).
double erf(double x) {
  constexpr int terms = 60;
  const double size = std::abs(x), gaussian = exp(-x * x) / std::sqrt(pi);
  if (size <= 2) {
    double sum = 1;
    for (int n = terms; n > 0; --n) sum = 1 + 2 * x * x / (2 * n + 1) * sum;
    return 2 * x * gaussian * sum;
  }
  double fraction = size;
  for (int n = terms; n > 0; --n) fraction = size + n / 2.0 / fraction;
  return std::copysign(1 - gaussian / fraction, x);
}

double hypot(double x, double y, double z) {
  const double largest = std::fmax(std::fmax(std::abs(x), std::abs(y)), std::abs(z));
  const double scale = largest > 0x1p500 ? 0x1p-600 : largest < 0x1p-480 ? 0x1p600 : 1;
  x *= scale;
  y *= scale;
  z *= scale;
  return std::sqrt(x * x + y * y + z * z) / scale;
}

}  // namespace rabiline::portable
