#include "simulation/blocks.hpp"

#include <gtest/gtest.h>

#include <set>

#include "physics/suggested.hpp"

namespace rabiline {
namespace {

TEST(Blocks, CoverEveryParticleOfEveryTreeOnce) {
  Experiment e;
  Beamline b = test::suggested(291e3);
  b.particles = 1237;
  e.points = {b, b};
  e.particles = ScanParticles::independent;
  const Plan plan = make_plan(e);
  const Blocks blocks(plan, block_sizes(plan, 1e-4));
  std::vector<std::uint64_t> next(plan.trees.size(), 0);
  for (std::uint64_t n = 0; n < blocks.count(); ++n) {
    const Block block = blocks.block(n);
    EXPECT_EQ(block.first, next[block.tree]);
    EXPECT_GT(block.last, block.first);
    next[block.tree] = block.last;
  }
  for (const std::uint64_t n : next) EXPECT_EQ(n, 1237U);
}

TEST(Blocks, AreSmallEnoughToBeSeenBetween) {
  Experiment e;
  for (int i = 0; i < 101; ++i) e.points.push_back(test::suggested(266e3 + i * 500));
  const Plan plan = make_plan(e);
  const Blocks blocks(plan, block_sizes(plan, 0.025));
  for (std::uint64_t n = 0; n < blocks.count(); ++n) {
    const Block block = blocks.block(n);
    EXPECT_LE(static_cast<double>(block.last - block.first) * plan.trees[block.tree].cost, 0.05);
  }
}

TEST(Intervals, HoldWhatWasPutInWhateverTheOrder) {
  Intervals intervals;
  std::set<std::uint64_t> expected;
  std::uint64_t n = 1;
  for (int i = 0; i < 500; ++i) {
    n = (n * 131) % 251;
    intervals.insert(n);
    expected.insert(n);
    EXPECT_EQ(intervals.size(), expected.size());
  }
  for (std::uint64_t k = 0; k < 260; ++k) EXPECT_EQ(intervals.contains(k), expected.count(k) == 1) << k;
  for (std::size_t i = 1; i < intervals.list().size(); ++i)
    EXPECT_GT(intervals.list()[i].first, intervals.list()[i - 1].second);
}

TEST(Intervals, JoinWhereTheyTouchOrOverlap) {
  Intervals a({{0, 5}, {9, 12}});
  a.insert(Intervals({{4, 9}, {20, 21}}));
  EXPECT_EQ(a.list(), (std::vector<std::pair<std::uint64_t, std::uint64_t>>{{0, 12}, {20, 21}}));
}

}  // namespace
}  // namespace rabiline
