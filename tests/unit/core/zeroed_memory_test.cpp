#include "core/zeroed_memory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

namespace rabiline::zeroed_memory_test {
namespace {

using Zeros = std::vector<std::int64_t, ZeroedMemory<std::int64_t>>;
using Line = struct alignas(64) { std::int64_t of[8]; };

TEST(ZeroedMemory, HoldsZerosWhereOtherNumbersStoodBefore) {
  for (const std::size_t count : {1, 3, 1000, 100'000, 3'000'000})
    for (int again = 0; again < 3; ++again) {
      Zeros numbers(count);
      ASSERT_EQ(std::ranges::count(numbers, 0), static_cast<std::ptrdiff_t>(count)) << count;
      std::ranges::fill(numbers, -1);
    }
}
TEST(ZeroedMemory, KeepsWhatStandsInItWhenItGrows) {
  Zeros numbers(1000);
  std::ranges::fill(numbers, 7);
  numbers.resize(2'000'000);
  EXPECT_EQ(std::ranges::count(numbers, 7), 1000);
  EXPECT_EQ(std::ranges::count(numbers, 0), 1'999'000);
  EXPECT_EQ(Zeros(numbers), numbers);
}
TEST(ZeroedMemory, BeginsAtAWholeCacheLine) {
  for (const std::size_t count : {1, 2, 5, 1000, 200'000}) {
    const std::vector<Line, ZeroedMemory<Line>> lines(count);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(lines.data()) % 64, 0U) << count;
  }
}
TEST(ZeroedMemory, ThatTheMachineDoesNotHaveThrows) {
  EXPECT_THROW(zeroed_memory(std::numeric_limits<std::size_t>::max() / 2), std::bad_alloc);
}

}  // namespace
}  // namespace rabiline::zeroed_memory_test
