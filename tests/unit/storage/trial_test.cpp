#include "storage/trial.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>

namespace rabiline::trial_test {
namespace {

TEST(Trial, EndsWellWhereWorkReturnsTrueAndNotWhereItEndsInAnyOtherWay) {
  EXPECT_TRUE(ends_well([] { return true; }));
  EXPECT_FALSE(ends_well([] { return false; }));
  EXPECT_FALSE(ends_well([] { return std::raise(SIGSEGV) == 0; }));
}

/// Else both processes would go on from here: the other one then ends as if all were well.
TEST(Trial, KeepsAnExceptionInTheOtherProcess) {
  const auto fail = []() -> bool { throw std::runtime_error("nothing there"); };
  try {
    EXPECT_FALSE(ends_well(fail));
  } catch (const std::runtime_error&) {
    _exit(0);
  }
}

TEST(Trial, ChangesNothingHere) {
  int changed = 0;
  EXPECT_TRUE(ends_well([&] { return ++changed == 1; }));
  EXPECT_EQ(changed, 0);
}

}  // namespace
}  // namespace rabiline::trial_test
