#include "plan/level_ways.hpp"

#include <gtest/gtest.h>

namespace rabiline::level_ways_test {
namespace {

Section section(double begin, double end, double field) {
  Section out;
  out.begin = begin;
  out.end = end;
  out.field = {0, 0, field};
  return out;
}

TEST(LevelsIn, FieldsAlongTheZAxisNeedNoWayWhereNothingTurnsRound) {
  const std::vector<Section> apart{section(0, 1, -1e-6), section(1, 2, 0), section(2, 3, 1e-6),
                                   section(3.5, 4, -1e-6), section(4, 5, -2e-6)};
  EXPECT_FALSE(needs_way(apart, -1, 6));
  EXPECT_TRUE(needs_way(apart, 0, 6)) << "levels are known in a field against the axis";
  EXPECT_TRUE(needs_way(apart, 0.5, 6)) << "likewise, within it";
  EXPECT_FALSE(needs_way(apart, 1, 6));
  EXPECT_TRUE(needs_way(apart, -1, 5)) << "levels are asked for at its end";
  EXPECT_TRUE(needs_way(apart, -1, 4.5));
  EXPECT_FALSE(needs_way(apart, -1, 3));
  EXPECT_TRUE(needs_way({section(0, 1, 1e-6), section(1, 2, -1e-6)}, -1, 3)) << "a field turns round";
  EXPECT_TRUE(needs_way({section(0, 1, -1e-200), section(1, 2, 1e-200)}, -1, 3)) << "however weak";
  EXPECT_FALSE(needs_way({section(0, 1, 1e-6), section(1, 2, 2e-6)}, 0, 2));
}

}  // namespace
}  // namespace rabiline::level_ways_test
