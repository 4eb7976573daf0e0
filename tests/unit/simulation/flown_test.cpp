#include "simulation/flown.hpp"

#include <gtest/gtest.h>

#include "core/call_off.hpp"
#include "physics/suggested.hpp"

namespace rabiline::flown_test {
namespace {

class ThreadSumsTest : public ::testing::Test {
 protected:
  ThreadSumsTest() : plan(make_plan(in_fields())) {}
  static Experiment in_fields() {
    Experiment e;
    Beamline b = test::suggested(291e3);
    b.law = DoradoLaw{};
    b.particles = 128;
    e.points.push_back(b);
    return e;
  }
  ParticleRange half(std::uint64_t number) const { return {64 * number, 0, 64 * number, 64 * number + 64}; }
  void fly(ThreadSums& sums, std::uint64_t number, bool slowly) {
    TreeRunner runner(best_isa(), Batch::capacity);
    sums.fly(runner, plan, half(number), {&stop}, slowly);
  }

  const Plan plan;
  std::atomic<bool> stop{false};
};

TEST_F(ThreadSumsTest, OfSlowParticlesAreThoseOfFastOnes) {
  ThreadSums fast, slow;
  for (const std::uint64_t number : {0, 1}) {
    fly(fast, number, false);
    fly(slow, number, true);
  }
  EXPECT_TRUE(slow.sums == fast.sums);
  EXPECT_EQ(slow.finished.list(), fast.finished.list());
}

TEST_F(ThreadSumsTest, HaveNothingOfSlowParticlesThatAreCalledOff) {
  ThreadSums sums;
  fly(sums, 0, true);
  const Sums before = sums.sums;
  stop = true;
  EXPECT_THROW(fly(sums, 1, true), CalledOff);
  EXPECT_TRUE(sums.sums == before);
  EXPECT_EQ(sums.finished.size(), 64U);
  EXPECT_FALSE(sums.torn);
}

TEST_F(ThreadSumsTest, LoseNothingOfWhatHasFlownToAStop) {
  ThreadSums sums;
  stop = true;
  EXPECT_THROW(fly(sums, 0, false), CalledOff);  // the first of all: nothing is in them yet
  EXPECT_EQ(sums.finished.size(), 0U);
  ThreadSums later;
  stop = false;
  fly(later, 0, false);
  stop = true;
  fly(later, 1, false);
  EXPECT_EQ(later.finished.size(), 128U);
  EXPECT_FALSE(later.torn);
}

}  // namespace
}  // namespace rabiline::flown_test
