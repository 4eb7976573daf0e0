#include "models/times.hpp"

#include <gtest/gtest.h>

namespace rabiline::times_test {
namespace {

TEST(TimesOf, AreThoseThatAreWrittenWhereLittleTurns) {
  const Times times = times_of(3, 0, 4);
  EXPECT_EQ(times.stride, 1U);
  EXPECT_EQ(times.all, (std::vector<double>{0, 1, 2, 3}));
}

TEST(TimesOf, AreSixteenForEachTurnAndEndWithTheDuration) {
  const Times times = times_of(0.7, 10, 12);
  EXPECT_EQ(times.stride, 15U);  // 160 times over 11 gaps
  EXPECT_EQ(times.all.size(), 166U);
  EXPECT_EQ(times.all.front(), 0);
  EXPECT_EQ(times.all.back(), 0.7);
}

}  // namespace
}  // namespace rabiline::times_test
