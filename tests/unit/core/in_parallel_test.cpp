#include "core/in_parallel.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace rabiline::in_parallel_test {
namespace {

TEST(InParallel, CallsEachNumberOnceOnAnyNumberOfThreads) {
  for (const int threads : {0, 1, 2, 7, 200}) {
    std::vector<int> called(100);
    in_parallel(called.size(), threads, [&](std::size_t i) { ++called[i]; });
    EXPECT_EQ(called, std::vector<int>(100, 1));
  }
  in_parallel(0, 3, [](std::size_t) { FAIL(); });
}

TEST(InParallel, ThrowsWhatWasThrownWhenAllElseIsDone) {
  std::vector<int> called(100);
  EXPECT_THROW(in_parallel(called.size(), 3,
                           [&](std::size_t i) {
                             ++called[i];
                             if (i == 10) throw std::runtime_error("ten");
                           }),
               std::runtime_error);
  EXPECT_EQ(called, std::vector<int>(100, 1));
}

}  // namespace
}  // namespace rabiline::in_parallel_test
