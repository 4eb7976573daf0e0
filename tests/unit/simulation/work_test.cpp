#include "simulation/work.hpp"

#include <gtest/gtest.h>

#include <set>

#include "physics/suggested.hpp"

namespace rabiline::work_test {
namespace {

Experiment two_points(std::uint64_t particles) {
  Experiment e;
  Beamline b = test::suggested(291e3);
  b.particles = particles;
  e.points = {b, b};
  e.particles = ScanParticles::independent;
  return e;
}

TEST(ParticleRow, HoldsEveryParticleOfEveryTreeOnce) {
  const Plan plan = make_plan(two_points(1237));
  for (const int halvings : {0, 3}) {
    const ParticleRow row(plan, halvings);
    std::vector<std::uint64_t> next(plan.trees.size(), 0);
    EXPECT_EQ(row.size(), 2 * 1237U);
    for (std::uint64_t place = 0; place < row.size();) {
      const ParticleRange range = row.at(place);
      EXPECT_EQ(range.place, place);
      EXPECT_EQ(range.first, next[range.tree]);
      EXPECT_GT(range.last, range.first);
      next[range.tree] = range.last;
      place += range.last - range.first;
    }
    for (const std::uint64_t n : next) EXPECT_EQ(n, 1237U);
    EXPECT_EQ(row.end_of_part(0), row.size());
  }
}

TEST(ParticleRow, ContinuesWithinATree) {
  const Plan plan = make_plan(two_points(1237));
  const ParticleRow row(plan);
  EXPECT_EQ(row.at(1300).tree, 1U);
  EXPECT_EQ(row.at(1300).first, 1300U - 1237U);
}

TEST(Pace, BeginsWithEightAndThenTakesWhatFitsIntoTheTime) {
  Pace pace(0.025);
  const double cost = 1e-6, really = 1e-4;  // [s] a hundred times slower than it was estimated
  double longest = 0;
  for (int i = 0; i < 20; ++i) {
    const std::uint64_t particles = pace.particles(cost);
    if (i == 0) {
      EXPECT_EQ(particles, 8U);
    }
    longest = std::max(longest, static_cast<double>(particles) * really);
    pace.took(static_cast<double>(particles) * cost, static_cast<double>(particles) * really);
  }
  EXPECT_LE(longest, 0.025);
  EXPECT_GT(longest, 0.02);
}

TEST(Shard, ShareOutEveryPlaceOnce) {
  for (const std::uint64_t all : {0U, 1U, 7U, 8U, 1000003U})
    for (const std::uint64_t of : {1U, 2U, 3U, 8U, 11U}) {
      std::uint64_t next = 0;
      for (std::uint64_t number = 1; number <= of; ++number) {
        const auto [begin, end] = Shard{number, of}.places(all);
        EXPECT_EQ(begin, next);
        EXPECT_LE(end - begin, all / of + 1);
        next = end;
      }
      EXPECT_EQ(next, all);
    }
}

TEST(Intervals, HoldWhatWasPutInWhateverTheOrder) {
  Intervals intervals;
  std::set<std::uint64_t> expected;
  std::uint64_t n = 1;
  for (int i = 0; i < 500; ++i) {
    n = (n * 131) % 251;
    intervals.insert(n, n + 1);
    expected.insert(n);
    EXPECT_EQ(intervals.size(), expected.size());
  }
  for (std::uint64_t k = 0; k < 260; ++k) {
    std::uint64_t missing = k;
    while (expected.contains(missing)) ++missing;
    EXPECT_EQ(intervals.gap(k).first, missing) << k;
  }
  for (std::size_t i = 1; i < intervals.list().size(); ++i)
    EXPECT_GT(intervals.list()[i].first, intervals.list()[i - 1].second);
}

TEST(Intervals, JoinWhereTheyTouchOrOverlap) {
  Intervals a({{0, 5}, {9, 12}});
  a.insert(Intervals({{4, 9}, {20, 21}}));
  EXPECT_EQ(a.list(), (Intervals::List{{0, 12}, {20, 21}}));
  EXPECT_EQ(a.gap(3), (std::pair<std::uint64_t, std::uint64_t>{12, 20}));
}

/// Of a run of 10 particles with two sums.
Snapshot flown(Shard shard, std::uint64_t sum) {
  Snapshot s;
  s.fingerprint = "one";
  s.particles = 10;
  s.shard = shard;
  s.finished = {shard.places(10)};
  s.sums = {9, {3, 3 + sum}, {1, 0}, {~std::uint64_t{0}, sum}};
  return s;
}
std::string refusal_of(const std::vector<Snapshot>& shards) {
  try {
    Merger merger;
    for (const Snapshot& shard : shards) merger.add("s" + std::to_string(shard.sums.low.back()), shard);
    merger.finish();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Merger, AddsTheSumsOfAllShardsInAnyOrder) {
  Merger merger;
  for (const std::uint64_t number : {3U, 1U, 2U}) merger.add("a", flown({number, 3}, number));
  const Snapshot all = merger.finish();
  EXPECT_EQ(all.shard, Shard{});
  EXPECT_EQ(all.finished, (Intervals::List{{0, 10}}));
  EXPECT_EQ(all.sums, (KeptSums{9, {3, 4, 5, 6}, {5, 0, 0, 0}, {~std::uint64_t{0} - 2, 1, 2, 3}}));
}

TEST(Merger, RefusesShardsThatOverlapOrAreForeignOrUnfinishedOrMissing) {
  EXPECT_EQ(refusal_of({flown({1, 2}, 1), flown({2, 2}, 2)}), "");
  EXPECT_NE(refusal_of({flown({1, 2}, 1), flown({1, 2}, 2)}).find("s1 and s2 are both shard 1/2"),
            std::string::npos);
  EXPECT_NE(refusal_of({flown({1, 4}, 1), flown({3, 4}, 3)}).find("missing: 2, 4"), std::string::npos);
  EXPECT_NE(refusal_of({flown({}, 1)}).find("s1: is of a run in one piece"), std::string::npos);
  EXPECT_NE(refusal_of({flown({1, 2}, 1), flown({2, 3}, 2)}).find("s2: is one of 3 shards"),
            std::string::npos);
  Snapshot foreign = flown({2, 2}, 2);
  foreign.fingerprint = "other";
  EXPECT_NE(refusal_of({flown({1, 2}, 1), foreign}).find("s2: is a shard of another run than s1"),
            std::string::npos);
  Snapshot half = flown({2, 2}, 2);
  half.finished = {{5, 7}};
  EXPECT_NE(refusal_of({flown({1, 2}, 1), half}).find("s2: shard 2/2 is not finished (40.0 % are)"),
            std::string::npos);
}

TEST(ParticleRow, TellsTheWorkByWhatEachTreeCosts) {
  Plan plan = make_plan(two_points(1000));
  ASSERT_EQ(plan.trees.size(), 2U);
  plan.trees[0].cost = 1e-6;
  plan.trees[1].cost = 3e-6;
  const ParticleRow row(plan);
  EXPECT_EQ(row.cost_before(0), 0);
  EXPECT_DOUBLE_EQ(row.cost_before(500), 0.5e-3);
  EXPECT_DOUBLE_EQ(row.cost_before(1000), 1e-3);
  EXPECT_DOUBLE_EQ(row.cost_before(1500), 2.5e-3);
  EXPECT_DOUBLE_EQ(row.cost_before(row.size()), 4e-3);
}

}  // namespace
}  // namespace rabiline::work_test
