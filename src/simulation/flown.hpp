#pragma once
// What has flown, by threads and in all.
#include <mutex>
#include <vector>

#include "core/call_off.hpp"
#include "plan/plan.hpp"
#include "simulation/ranks.hpp"
#include "simulation/snapshot.hpp"
#include "simulation/tree_runner.hpp"
#include "simulation/work.hpp"

namespace rabiline {

/// What one thread has flown since it was asked last. The lock is held while particles fly into them, so
/// that whole stretches only are seen.
struct ThreadSums {
  std::mutex lock;
  Sums sums;  // none before it flies
  Intervals finished;
  std::vector<Straggler> stragglers;
  bool torn = false;  // an exception came out of a stretch, of which the sums have a part

  /// Particles of a tree of the plan. CalledOff where a stop is asked for while slow ones are on their way,
  /// which fly apart from the sums, so that neither a stop nor a snapshot waits for them; the first ones of
  /// all may be as slow as they like and tear nothing.
  void fly(TreeRunner&, const Plan&, const ParticleRange&, const Call& stop, bool slowly);
};

/// What has flown in all. Of several ranks the leader has it; the others only hand over what is theirs.
struct Flown {
  Sums sums;  // none before they are collected
  Intervals finished;
  std::vector<Straggler> stragglers;  // ascending, each once

  /// Of a run that begins, or goes on from there.
  Flown(const Plan&, const Snapshot* start);
  /// Takes everything from all threads of all ranks. What a torn one has is lost.
  void collect(std::vector<ThreadSums>&, Ranks&);
  /// Of it, without what is known of the run.
  Snapshot snapshot() const;

 private:
  std::size_t size_;  // of the sums
};

}  // namespace rabiline
