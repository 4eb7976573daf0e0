#include "models/ode.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace rabiline::ode_test {
namespace {

TEST(Integrate, KeepsAnOscillatorOnItsCircleForAHundredTurns) {
  std::vector<double> times;
  for (int i = 0; i <= 1000; ++i) times.push_back(0.6283185307179586 * i);
  const auto rows = integrate(
      [](double, std::span<const double> y, std::span<double> d) {
        d[0] = y[1];
        d[1] = -y[0];
      },
      {1, 0}, times);
  ASSERT_EQ(rows.size(), times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_NEAR(rows[i][0], std::cos(times[i]), 1e-10);
    EXPECT_NEAR(rows[i][1], -std::sin(times[i]), 1e-10);
  }
}

TEST(Integrate, SaysWhereTheMotionCannotBeFollowed) {
  const std::array<double, 2> times{0, 2};
  EXPECT_THROW(integrate([](double, std::span<const double> y, std::span<double> d) { d[0] = y[0] * y[0]; },
                         {1}, times),
               std::runtime_error);
}

}  // namespace
}  // namespace rabiline::ode_test
