#include "simulation/ranks.hpp"

#include <gtest/gtest.h>

#include "physics/suggested.hpp"
#include "simulation/dealer.hpp"
#include "simulation/run.hpp"
#include "team.hpp"

namespace rabiline::ranks_test {
namespace {

/// Two species, whose trees cost differently, at three independent points.
Experiment small(std::uint64_t particles) {
  Experiment e;
  const Species lithium{"Li-7", 1.165e-26, 0, {3}, 1.0397e8, ""};
  for (const double frequency : {290e3, 291e3, 291.6e3}) {
    Beamline b = test::suggested(frequency);
    b.species = {{test::neutron(), 0.5}, {lithium, 0.5}};
    b.particles = particles;
    e.points.push_back(b);
  }
  return e;
}

RunOptions options_for(int threads) {
  RunOptions options;
  options.isa = best_isa();
  options.threads = threads;
  options.grain = 1e-5;
  return options;
}

/// What the leader of a team has in the end.
RunOutcome run_as_team(const Plan& plan, int ranks,
                       const std::function<void(RunOptions&, Ranks&)>& change = {}) {
  RunOutcome out;
  test::as_team(ranks, [&](Ranks& own) {
    RunOptions options = options_for(own.rank() + 1);
    options.ranks = &own;
    if (change) change(options, own);
    RunOutcome outcome = run(plan, options);
    if (own.leads()) out = std::move(outcome);
  });
  return out;
}

TEST(Ranks, FlyARunTogetherToTheSameBits) {
  const Plan plan = make_plan(small(20000));
  const RunOutcome alone = run(plan, options_for(1));
  for (const int ranks : {1, 2, 4}) {
    const RunOutcome together = run_as_team(plan, ranks);
    EXPECT_TRUE(together.finished);
    EXPECT_TRUE(together.sums == alone.sums) << ranks << " ranks";
    EXPECT_EQ(together.stragglers, alone.stragglers);
  }
}

TEST(Ranks, FlyAShardTogether) {
  const Plan plan = make_plan(small(2000));
  RunOptions shard = options_for(1);
  shard.shard = {2, 3};
  const RunOutcome together = run_as_team(plan, 3, [](RunOptions& options, Ranks&) {
    options.shard = {2, 3};
  });
  EXPECT_TRUE(together.sums == run(plan, shard).sums);
}

TEST(Ranks, AreAllStoppedByTheSignalOfOneAndGoOnInAnyNumber) {
  const Plan plan = make_plan(small(80000));
  const Sums expected = run(plan, options_for(2)).sums;
  std::atomic<bool> stop{false};
  Snapshot kept;
  const RunOutcome stopped = run_as_team(plan, 3, [&](RunOptions& options, Ranks& own) {
    if (own.rank() == 2) options.stop = &stop;
    if (!own.leads()) return;
    options.snapshot_seconds = 0;
    options.snapshot = [&](const Snapshot& snapshot) {
      kept = snapshot;
      if (!snapshot.finished.empty()) stop = true;
    };
  });
  EXPECT_FALSE(stopped.finished);
  EXPECT_GT(kept.done(), 0);
  EXPECT_LT(kept.done(), 1);
  for (const int ranks : {1, 2}) {
    const RunOutcome rest =
        run_as_team(plan, ranks, [&](RunOptions& options, Ranks&) { options.start = &kept; });
    EXPECT_TRUE(rest.finished);
    EXPECT_TRUE(rest.sums == expected) << ranks << " ranks";
  }
}

TEST(Ranks, EndAtThePrecisionOfAllOfThem) {
  const Plan plan = make_plan(small(16000));
  const auto enough = [](RunOptions& options) {
    options.halvings = 4;
    options.enough = [](const Sums&, const auto&, int halvings) { return halvings == 2; };
  };
  RunOptions options = options_for(1);
  enough(options);
  const RunOutcome alone = run(plan, options);
  const RunOutcome together = run_as_team(plan, 3, [&](RunOptions& o, Ranks&) { enough(o); });
  EXPECT_EQ(together.halvings, 2);
  EXPECT_TRUE(together.sums == alone.sums);
}

TEST(Ranks, EndTogetherWhereOneFailsAndKeepWhatHasFlown) {
  const Plan plan = make_plan(small(80000));
  Snapshot kept;
  std::atomic<int> failures{0};
  test::as_team(3, [&](Ranks& own) {
    RunOptions options = options_for(1);
    options.ranks = &own;
    if (own.leads()) {
      options.snapshot_seconds = 0;
      options.snapshot = [&](const Snapshot& snapshot) {
        kept = snapshot;
        if (!snapshot.finished.empty()) throw std::runtime_error("the disk is gone");
      };
    }
    try {
      run(plan, options);
    } catch (const RankFailure& failure) {
      ++failures;
      if (own.leads()) {
        EXPECT_STREQ(failure.what(), "rank 0 of 3 failed: the disk is gone");
      }
    }
  });
  EXPECT_EQ(failures, 3);
  EXPECT_TRUE(fits(kept, plan));
  RunOptions options = options_for(2);
  options.start = &kept;
  EXPECT_TRUE(run(plan, options).sums == run(plan, options_for(2)).sums);
}

TEST(Dealer, GivesEachPlaceToOneAndSharesOutTheRest) {
  const Plan plan = make_plan(small(10000));
  const ParticleRow row(plan);
  const Intervals flown({{10, 30}, {500, 2000}});
  Dealer dealer(plan, row, flown);
  dealer.open(0, row.size());
  std::uint64_t place = 0, particles = 0;
  const double all = [&] {
    Dealer other(plan, row, flown);
    other.open(0, row.size());
    return other.deal({{1e30, 0}})[0].cost;
  }();
  for (int round = 0; !dealer.is_done(); ++round) {
    const std::vector<Deal> deals = dealer.deal({{all / 3, 0}, {0, 0}, {0, 8}, {all / 4, 0}});
    for (const Deal& deal : deals) {
      EXPECT_EQ(deal.begin, place);
      place = deal.end;
      particles += deal.particles;
    }
    EXPECT_EQ(deals[1].particles, 0U);
    if (dealer.is_done()) {
      EXPECT_NEAR(deals[3].cost / deals[0].cost, 0.75, 0.2);
    }
    ASSERT_LT(round, 2);
  }
  EXPECT_EQ(place, row.size());
  EXPECT_EQ(particles, row.size() - flown.size());
}

}  // namespace
}  // namespace rabiline::ranks_test
