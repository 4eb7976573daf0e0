// The host's elementary functions against long double ones, within the errors that the header states.
#include "core/portable_math.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace rabiline::portable_math_test {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon(), pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Evenly spread between the limits, the limits themselves, and points ever closer to zero of either sign.
std::vector<double> numbers(double from, double to) {
  std::mt19937_64 generator(1938);
  std::uniform_real_distribution<double> even(from, to);
  std::vector<double> all{from, to};
  for (int i = 0; i < 20000; ++i) all.push_back(even(generator));
  for (double near = to; near > 1e-300; near /= 7) {
    all.push_back(near);
    if (-near >= from) all.push_back(-near);
  }
  return all;
}

/// The largest error over `from` to `to`, relative to the value or to `least`, whichever is larger.
template <class Function, class Reference>
double worst(Function function, Reference reference, double from, double to, long double least = 0) {
  long double largest = 0;
  for (const double x : numbers(from, to)) {
    const long double expected = reference(x), size = std::max(std::abs(expected), least);
    if (size == 0) continue;
    if (const long double error = std::abs(function(x) - expected) / size; !(error <= largest))
      largest = error;
  }
  return static_cast<double>(largest);
}

TEST(PortableMath, HasTheSineAndTheCosineOfTheLanes) {
  for (const double limit : {1.0, 10.0, 1e5, 1e9}) {
    EXPECT_LT(worst(portable::sin, sinl, -limit, limit, 1), eps) << limit;
    EXPECT_LT(worst(portable::cos, cosl, -limit, limit, 1), eps) << limit;
  }
  EXPECT_LT(worst(portable::sin, sinl, -6, 6), eps);
  EXPECT_EQ(portable::sin(pi), 0x1.1a62633145c07p-53);
  EXPECT_LT(worst(portable::tan, tanl, -10, 10), 4 * eps);
}

TEST(PortableMath, HasTheArcsOfAllSlopes) {
  EXPECT_LT(worst(portable::atan, atanl, -20, 20), 2 * eps);
  EXPECT_LT(worst(portable::asin, asinl, -1, 1), 4 * eps);
  EXPECT_LT(worst(portable::acos, acosl, -1, 1), 4 * eps);
  EXPECT_EQ(portable::acos(1), 0);
  EXPECT_EQ(portable::atan(infinity), pi / 2);
  for (const double x : {-3.0, -1.0, -1e-9, -0.0, 0.0, 1e-9, 2.0})
    for (const double y : {-2.0, -1.0, -1e-12, -0.0, 0.0, 1e-12, 5.0}) {
      EXPECT_NEAR(portable::atan2(y, x), std::atan2(y, x), 4 * eps) << y << " " << x;
      EXPECT_EQ(std::signbit(portable::atan2(y, x)), std::signbit(y)) << y << " " << x;
    }
}

TEST(PortableMath, HasExponentialsAndLogarithmsOfEverySize) {
  EXPECT_LT(worst(portable::exp, expl, -708, 709), 4 * eps);
  EXPECT_EQ(portable::exp(-1e4), 0);
  EXPECT_EQ(portable::exp(1e4), infinity);
  EXPECT_NEAR(portable::exp(-740) / std::exp(-740), 1, 1e-2);  // a few bits are left
  EXPECT_LT(worst(portable::log, logl, 0x1p-1022, 10), 2 * eps);
  EXPECT_LT(worst(portable::log, logl, 1, 1e300), 2 * eps);
  EXPECT_NEAR(portable::log(5e-324), std::log(5e-324), 1e-12);
  EXPECT_EQ(portable::log(0), -infinity);
  EXPECT_TRUE(std::isnan(portable::log(-1)));
}

TEST(PortableMath, HasTheInverseOfTheHyperbolicSine) {
  EXPECT_LT(worst(portable::asinh, asinhl, -50, 50), 8 * eps);
}

TEST(PortableMath, HasPowersOfBothKinds) {
  for (const double y : {-3.5, 0.25, 1.0 / 9, 30.0})
    for (const double x : {1e-6, 0.3, 0.999, 7.0, 1e5}) {
      const long double expected = std::pow(static_cast<long double>(x), static_cast<long double>(y));
      EXPECT_NEAR(static_cast<double>(portable::pow(x, y) / expected), 1,
                  (4 + 2 * std::abs(y * std::log(x))) * eps)
          << x << " " << y;
    }
  EXPECT_EQ(portable::pow(-3.0, 3), -27);
  EXPECT_EQ(portable::pow(10.0, 22), 1e22);
  EXPECT_EQ(portable::pow(2.0, -3), 0.125);
  EXPECT_EQ(portable::pow(0.0, 0), 1);
}

TEST(PortableMath, HasTheErrorFunction) {
  EXPECT_LT(worst(portable::erf, erfl, -7, 7), 8 * eps);
  EXPECT_EQ(portable::erf(infinity), 1);
}

TEST(PortableMath, HasLengthsThatNeitherOverflowNorVanish) {
  const auto diagonal = [](double x) { return portable::hypot(x, 0.3 * x, -2 * x); };
  const auto expected = [](long double x) { return std::sqrt(x * x * (1 + 0.3L * 0.3L + 4)); };
  EXPECT_LT(worst(diagonal, expected, -1e100, 1e100), 2 * eps);
  EXPECT_EQ(portable::hypot(3e300, 4e300), 5e300);
  EXPECT_DOUBLE_EQ(portable::hypot(3e-300, 4e-300), 5e-300);
  EXPECT_EQ(portable::hypot(0, 0), 0);
  EXPECT_EQ(portable::hypot(-infinity, 1), infinity);
}

}  // namespace
}  // namespace rabiline::portable_math_test
