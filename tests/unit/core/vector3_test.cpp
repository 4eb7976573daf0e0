#include "core/vector3.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace rabiline::vector3_test {
namespace {

TEST(TurnedAbout, TurnsRightHandedAndKeepsTheLength) {
  const Vector3 v = turned_about({0, 0, 1}, std::numbers::pi / 2, {2, 0, 1});
  EXPECT_NEAR(length_of(v - Vector3{0, 2, 1}), 0, 1e-15);
  EXPECT_EQ(turned_about({0, 1, 0}, 0, v), v);
}

TEST(AngleBetween, IsExactForAnglesThatACosineCannotTell) {
  EXPECT_NEAR(angle_between({1, 0, 0}, {2, 2e-9, 0}), 1e-9, 1e-20);
  EXPECT_EQ(angle_between({0, 3, 0}, {0, -1, 0}), std::numbers::pi);
}

TEST(IsParallel, HoldsForVectorsAlongOneLineAndForNone) {
  EXPECT_TRUE(is_parallel({1, 2, 3}, {-3, -6, -9}));
  EXPECT_TRUE(is_parallel({1, 2, 3}, {}));
  EXPECT_FALSE(is_parallel({0, 0, 1}, {0, 1e-9, 1}));
}

}  // namespace
}  // namespace rabiline::vector3_test
