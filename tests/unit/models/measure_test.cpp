#include "models/measure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rabiline::measure_test {
namespace {

TEST(AnglesAbout, FollowAVectorThroughManyTurnsAboutAnyAxis) {
  const Vector3 axis = (1 / std::sqrt(14.0)) * Vector3{1, -2, 3};
  std::vector<Vector3> vectors;
  for (int i = 0; i <= 100; ++i) vectors.push_back(turned_about(axis, -2.9 * i, {0.3, 1, -0.2}));
  EXPECT_NEAR(angles_about(axis, vectors).back(), -290, 1e-10);
}

TEST(RadiusOf, FindsACircleFromPartOfItAndNoneOnALine) {
  std::vector<Vector3> arc, line;
  for (int i = 0; i < 40; ++i) {
    arc.push_back({1e-6 + 7e-6 * std::cos(0.05 * i), 7e-6 * std::sin(0.05 * i), 0.1 * i});
    line.push_back({3e-6 * i, -2e-6 * i, 0});
  }
  EXPECT_NEAR(radius_of(arc).value() / 7e-6, 1, 1e-12);
  EXPECT_EQ(radius_of(line), std::nullopt);
  EXPECT_EQ(radius_of(std::vector<Vector3>(5, Vector3{1, 2, 3})), std::nullopt);
}

TEST(MeanRate, AveragesOutWhatSwings) {
  std::vector<double> times, values;
  for (int i = 0; i <= 2000; ++i) {
    times.push_back(0.05 * i);
    values.push_back(0.3 - 0.02 * times.back() + 0.1 * std::cos(6.1 * times.back()));
  }
  EXPECT_NEAR(mean_rate(times, values), -0.02, 1e-10);
}

}  // namespace
}  // namespace rabiline::measure_test
