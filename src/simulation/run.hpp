#pragma once
// The loop over all particles, on all threads, with progress and snapshots. Knows no files.
#include <algorithm>
#include <atomic>
#include <functional>
#include <string>
#include <utility>

#include "core/call_off.hpp"
#include "plan/plan.hpp"
#include "simulation/ranks.hpp"
#include "simulation/snapshot.hpp"

namespace rabiline {

struct RunOptions {
  int threads = 1;
  Isa isa = Isa::baseline;
  int batch = Batch::capacity;  // particles that go through the loops together; a multiple of 8
  double grain = 0.025;         // [s] of work that a thread takes at once, but never less than 8 particles
  const std::atomic<bool>* stop = nullptr;  // asks it to end, as does
  Call::Clock::time_point latest = Call::Clock::time_point::max();
  std::function<void(const Progress&)> progress;  // by the calling thread, a few times a second
  std::function<void(Snapshot)> snapshot;         // likewise, every snapshot_seconds and at the end
  double snapshot_seconds = 60;
  const Snapshot* start = nullptr;  // goes on from here; must fit
  Shard shard;                      // of the work; only where there are no halvings
  /// Where this is a slab of a longer run: places of its row in front of this plan's, and of all of it.
  std::uint64_t before = 0, of_run = 0;
  /// How often the particles may be halved (part_of), and whether the sums of a part are enough: asked about
  /// one part after the other until they are.
  int halvings = 0;
  std::function<bool(const Sums&, const std::vector<Straggler>&, int halvings)> enough;
  /// That fly it together; the leader alone calls the functions above and has sums in the end. Of what a run
  /// starts from, all know what has flown, the leader its sums.
  Ranks* ranks = nullptr;

  /// Of so many places of the plan those that are to be flown.
  std::pair<std::uint64_t, std::uint64_t> places(std::uint64_t size) const {
    const auto [begin, end] = shard.places(of_run == 0 ? size : of_run);
    const auto within = [&](std::uint64_t place) {
      return std::clamp(place, before, before + size) - before;
    };
    return {within(begin), within(end)};
  }
};

/// What a run leaves: its sums, and whether all particles are in them.
struct RunOutcome {
  Sums sums;
  std::vector<Straggler> stragglers;  // ascending, each once
  bool finished = false;
  int halvings = 0;     // of the part that was enough
  KeptSums of_slabs{};  // instead of sums, where slabs flew one behind the other
};

inline bool is_of(const Straggler& s, const Plan& plan) {
  return s.tree < plan.trees.size() && s.particle >= plan.trees[s.tree].first &&
         s.particle < plan.trees[s.tree].last;
}
/// Whether a run of this plan can go on from the snapshot.
bool fits(const Snapshot&, const Plan&);

/// Flies every particle of the plan through its tree. The sums are the same bits for any number of threads,
/// any batch size, any instruction set, any number of ranks, and however often the run was stopped and went
/// on. Where a thread fails, what the others have flown goes to the snapshot first; then its exception is
/// thrown, or RankFailure where there are several ranks.
RunOutcome run(const Plan&, const RunOptions&);

}  // namespace rabiline
