// The functions of core/lanes.hpp against long double libm, on every instruction set of this machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "lanes_kernels.hpp"

namespace rabiline::functions_test {
namespace {

using Reference = std::function<long double(long double)>;
using Unary = std::function<void(const LanesKernels&, const Column&, Column&)>;

std::vector<Isa> isas_here() {
  std::vector<Isa> isas;
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512})
    if (supported(isa)) isas.push_back(isa);
  return isas;
}

/// The largest of |f(x) - reference(x)| / scale(reference(x)), over all x and all instruction sets.
double worst_error(std::vector<double> x, const Unary& f, const Reference& reference,
                   const Reference& scale) {
  while (x.size() % Column::length != 0) x.push_back(x.front());
  long double worst = 0;
  const auto in = std::make_unique<Column>(), out = std::make_unique<Column>();
  for (std::size_t start = 0; start < x.size(); start += Column::length) {
    std::copy_n(x.begin() + static_cast<std::ptrdiff_t>(start), Column::length, in->value);
    std::vector<long double> expected;
    for (const double value : in->value) expected.push_back(reference(value));
    for (const Isa isa : isas_here()) {
      f(lanes_kernels_for(isa), *in, *out);
      for (int i = 0; i < Column::length; ++i) {
        const long double error = std::abs(out->value[i] - expected[i]) / scale(expected[i]);
        if (!(error <= worst)) worst = error;
      }
    }
  }
  return static_cast<double>(worst);
}

long double one(long double) { return 1; }
long double sin_squared_reference(long double x) { return std::sin(x) * std::sin(x); }

const Unary sine = [](const LanesKernels& k, const Column& x, Column& y) {
  Column unused;
  k.sincos(x, y, unused);
};
const Unary cosine = [](const LanesKernels& k, const Column& x, Column& y) {
  Column unused;
  k.sincos(x, unused, y);
};
const Unary square_of_sine = [](const LanesKernels& k, const Column& x, Column& y) { k.sin_squared(x, y); };
const Unary exponential = [](const LanesKernels& k, const Column& x, Column& y) { k.exp(x, y); };
const Unary logarithm = [](const LanesKernels& k, const Column& x, Column& y) { k.log(x, y); };

/// Both signs, evenly spread in x up to the limit and evenly spread in log x from 1e-300.
std::vector<double> angles(double limit) {
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> even(-limit, limit), exponent(-300, std::log10(limit));
  std::vector<double> x;
  for (int i = 0; i < 40 * Column::length; ++i) {
    x.push_back(even(generator));
    x.push_back(std::copysign(std::pow(10.0, exponent(generator)), x.back()));
  }
  return x;
}

/// The doubles nearest to multiples of pi/4 and their neighbours, where quadrants change and where sine or
/// cosine nearly vanishes.
std::vector<double> multiples_of_quarter_pi() {
  std::vector<double> x = {0.0, -0.0};
  for (long long n = 1; n < 1'200'000'000; n += 1 + n / 3000)
    for (const double sign : {-1.0, 1.0}) {
      const double multiple =
          static_cast<double>(sign * static_cast<long double>(n) * 0.785398163397448309615660845819875721L);
      for (const double towards : {-2e9, 0.0, 2e9})
        x.push_back(towards == 0.0 ? multiple : std::nextafter(multiple, towards));
    }
  return x;
}

TEST(Sincos, is_within_2e_16_of_the_truth_up_to_1e9_radians) {
  for (const double limit : {1.0, 10.0, 1e3, 1e5, 1e9}) {
    EXPECT_LT(worst_error(angles(limit), sine, sinl, one), 2e-16) << limit;
    EXPECT_LT(worst_error(angles(limit), cosine, cosl, one), 2e-16) << limit;
  }
}

TEST(Sincos, is_within_2e_16_of_the_truth_at_multiples_of_quarter_pi) {
  EXPECT_LT(worst_error(multiples_of_quarter_pi(), sine, sinl, one), 2e-16);
  EXPECT_LT(worst_error(multiples_of_quarter_pi(), cosine, cosl, one), 2e-16);
}

TEST(Sincos, returns_a_tiny_angle_itself_as_its_sine) {
  EXPECT_EQ(worst_error(
                {1e-300, -1e-300, 1e-20, 5e-324}, sine, [](long double x) { return x; }, one),
            0);
  EXPECT_EQ(worst_error({1e-300, -1e-300, 1e-20, 0.0}, cosine, one, one), 0);
}

TEST(SinSquared, is_within_6e_16_of_the_truth_up_to_1e9_radians) {
  for (const double limit : {1.0, 10.0, 1e3, 1e5, 1e9})
    EXPECT_LT(worst_error(angles(limit), square_of_sine, sin_squared_reference, one), 6e-16) << limit;
  EXPECT_LT(worst_error(multiples_of_quarter_pi(), square_of_sine, sin_squared_reference, one), 6e-16);
}

TEST(SinSquared, never_exceeds_one_where_it_is_one) {
  std::vector<double> x;
  for (int i = 0; i < 100 * Column::length; ++i)
    x.push_back(1.5707963267948966 * (1 + 2 * (i % 1000)) + 1e-12 * (i % 77 - 38));
  const Unary excess = [](const LanesKernels& k, const Column& angle, Column& y) {
    k.sin_squared(angle, y);
    for (double& value : y.value) value = std::max(value - 1.0, 0.0);
  };
  EXPECT_EQ(worst_error(
                x, excess, [](long double) { return 0; }, one),
            0);
}

TEST(Log, is_within_a_relative_2p2e_16_of_the_truth_for_every_normal_number) {
  std::mt19937_64 generator(11);
  std::uniform_real_distribution<double> even(0, 1), exponent(-1022, 1024);
  std::vector<double> x = {std::numeric_limits<double>::min(), std::numeric_limits<double>::max(), 2.0, 0.5};
  for (int i = 0; i < 40 * Column::length; ++i) {
    x.push_back(even(generator));
    x.push_back(0.5 + 2.5 * even(generator));
    x.push_back(std::max(std::exp2(exponent(generator)), std::numeric_limits<double>::min()));
  }
  const Reference size = [](long double y) { return std::abs(y); };
  EXPECT_LT(worst_error(x, logarithm, logl, size), 2.2e-16);
}

TEST(Exp, is_within_a_relative_4e_16_of_the_truth_between_its_limits) {
  std::mt19937_64 generator(12);
  std::uniform_real_distribution<double> wide(-700, 700), narrow(-1, 1);
  std::vector<double> x = {0.0, -0.0, 1.0, -700.0, 700.0, 1e-300};
  for (int i = 0; i < 40 * Column::length; ++i) {
    x.push_back(wide(generator));
    x.push_back(narrow(generator));
  }
  const Reference size = [](long double y) { return std::abs(y); };
  EXPECT_LT(worst_error(x, exponential, expl, size), 4e-16);
  EXPECT_EQ(worst_error({0.0}, exponential, expl, one), 0);
}

TEST(Log, keeps_its_relative_accuracy_near_one) {
  std::vector<double> x;
  double below = 1.0, above = 1.0;
  for (int i = 0; i < Column::length; ++i) {
    x.push_back(below = std::nextafter(below, 0.0));
    x.push_back(above = std::nextafter(above, 2.0));
    x.push_back(1.0 - std::exp2(-1.0 - i / 80.0));
    x.push_back(1.0 + std::exp2(-1.0 - i / 80.0));
  }
  std::erase(x, 1.0);
  const Reference size = [](long double y) { return std::abs(y); };
  EXPECT_LT(worst_error(x, logarithm, logl, size), 2.2e-16);
  EXPECT_EQ(worst_error({1.0}, logarithm, logl, one), 0);
}

TEST(Atan, is_within_4e_16_of_the_truth_for_every_slope) {
  const Unary arctangent = [](const LanesKernels& k, const Column& x, Column& y) { k.atan(x, y); };
  std::vector<double> x = angles(10);
  for (const double edge : {0.41421356237309503, 1.0})
    for (const double sign : {-1.0, 1.0})
      for (const double to : {0.0, 2.0}) x.push_back(sign * std::nextafter(edge, to));
  x.insert(x.end(), {0.0, -0.0, 1e300, -1e300, std::numeric_limits<double>::infinity()});
  EXPECT_LT(worst_error(x, arctangent, atanl, one), 4e-16);
}

/// sin(a)/a and (1 - cos a)/a^2 of q = a^2, without the cancellation at small a.
long double sine_coefficient(long double q) { return q == 0 ? 1 : std::sin(std::sqrt(q)) / std::sqrt(q); }
long double cosine_coefficient(long double q) {
  if (q == 0) return 0.5L;
  const long double half = std::sin(std::sqrt(q) / 2);
  return 2 * half * half / q;
}

TEST(RotationCoefficients, agree_with_the_closed_form_up_to_one_radian) {
  const Unary S = [](const LanesKernels& k, const Column& q, Column& y) {
    Column unused;
    k.rotation_coefficients(q, y, unused);
  };
  const Unary C = [](const LanesKernels& k, const Column& q, Column& y) {
    Column unused;
    k.rotation_coefficients(q, unused, y);
  };
  std::vector<double> q = {0.0, 1e-300, 1e-20, 1e-8, 1.0};
  for (int i = 0; i < 50 * Column::length; ++i) q.push_back((i + 0.5) / (50 * Column::length));
  EXPECT_LT(worst_error(q, S, sine_coefficient, one), 1.2e-16);
  EXPECT_LT(worst_error(q, C, cosine_coefficient, one), 6e-17);
}

}  // namespace
}  // namespace rabiline::functions_test
