#include "simulation/run.hpp"

#include <omp.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <mutex>
#include <utility>

#include "simulation/blocks.hpp"
#include "simulation/walk.hpp"

namespace rabiline {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// What one thread has done. The lock is held while a block is under way, so that a snapshot sees whole
/// blocks only.
struct Share {
  std::mutex lock;
  Sums sums;
  Intervals finished;
  std::vector<Straggler> stragglers;
};

void keep_each_once(std::vector<Straggler>& stragglers) {
  std::sort(stragglers.begin(), stragglers.end());
  stragglers.erase(std::unique(stragglers.begin(), stragglers.end()), stragglers.end());
}

Sums sums_of(const Snapshot& snapshot) {
  Sums sums(snapshot.sums_low.size());
  for (std::size_t i = 0; i < sums.size(); ++i)
    sums[i] = (static_cast<Sum>(snapshot.sums_high[i]) << 64) | snapshot.sums_low[i];
  return sums;
}

Blocks blocks_of(const Plan& plan, const RunOptions& options) {
  return {plan,
          options.start != nullptr ? options.start->block_sizes : block_sizes(plan, options.most_block_cost),
          options.halvings};
}

/// One run: threads take blocks until none is left or somebody asks to stop.
class Runner {
 public:
  Runner(const Plan& plan, const RunOptions& options)
      : plan_(plan),
        options_(options),
        blocks_(blocks_of(plan, options)),
        shares_(static_cast<std::size_t>(options.threads)) {
    for (Share& share : shares_) share.sums.resize(plan.sums);
    if (options.start != nullptr) {
      before_ = Intervals(options.start->finished);
      shares_.front().sums = sums_of(*options.start);
      shares_.front().stragglers = options.start->stragglers;
    }
    finished_blocks_ = before_.size();
  }

  RunOutcome run() {
    int left = options_.halvings;
    for (;; --left) {
      if (!finished_part(left)) fly_part(left);
      if (!finished_part(left) || left == 0 || is_enough(left)) break;
    }
    const bool finished = finished_part(left);
    if (!finished && options_.snapshot) options_.snapshot(snapshot());
    RunOutcome out{std::move(shares_.front().sums), std::move(shares_.front().stragglers), finished, left};
    for (std::size_t i = 1; i < shares_.size(); ++i) {
      add(out.sums, std::exchange(shares_[i].sums, {}));
      out.stragglers.insert(out.stragglers.end(), shares_[i].stragglers.begin(), shares_[i].stragglers.end());
    }
    keep_each_once(out.stragglers);
    return out;
  }

 private:
  bool finished_part(int halvings) const { return finished_blocks_ >= blocks_.end_of_part(halvings); }
  /// What was flown beyond a part was flown because the part was not enough.
  bool is_enough(int halvings) {
    return finished_blocks_ == blocks_.end_of_part(halvings) && options_.enough(collect().sums, halvings);
  }
  void fly_part(int halvings) {
    end_ = blocks_.end_of_part(halvings);
    next_ = halvings == options_.halvings ? 0 : blocks_.end_of_part(halvings + 1);
#pragma omp parallel num_threads(options_.threads)
    work(shares_[static_cast<std::size_t>(omp_get_thread_num())]);
    if (error_) std::rethrow_exception(error_);
  }
  bool stopped() const { return failed_ || (options_.stop != nullptr && *options_.stop); }

  /// One thread's loop. No exception leaves it.
  void work(Share& share) {
    try {
      Walker walker(options_.isa, options_.batch);
      for (std::uint64_t number = next_++; number < end_ && !stopped(); number = next_++) {
        if (before_.contains(number)) continue;
        {
          const std::lock_guard guard(share.lock);
          const Block block = blocks_.block(number);
          walker.fly(plan_.trees[block.tree], block.first, block.last, share.sums);
          share.finished.insert(number);
          for (const std::uint64_t particle : walker.stragglers())
            share.stragglers.push_back({block.tree, particle});
        }
        ++finished_blocks_;
        report();
      }
    } catch (...) {
      const std::lock_guard guard(error_lock_);
      error_ = std::current_exception();
      failed_ = true;
    }
  }

  /// Whichever thread comes by when it is time; one at a time.
  void report() {
    const std::unique_lock turn(report_lock_, std::try_to_lock);
    if (!turn) return;
    const double seconds = seconds_since(start_);
    if (options_.progress && seconds >= next_progress_) {
      const double all = static_cast<double>(end_), done = static_cast<double>(finished_blocks_) / all;
      const double done_now = done - static_cast<double>(before_.size()) / all;
      options_.progress({done, seconds, done_now > 0 ? seconds * (1 - done) / done_now : 0});
      next_progress_ = seconds + 0.2;
    }
    if (options_.snapshot && seconds >= next_snapshot_) {
      options_.snapshot(snapshot());
      next_snapshot_ = seconds_since(start_) + options_.snapshot_seconds;
    }
  }

  /// Of all threads and of the runs before.
  struct Collected {
    Sums sums;
    Intervals finished;
    std::vector<Straggler> stragglers;
  };
  Collected collect() {
    Collected all{Sums(plan_.sums), before_, {}};
    for (Share& share : shares_) {
      const std::lock_guard guard(share.lock);
      add(all.sums, share.sums);
      all.finished.insert(share.finished);
      all.stragglers.insert(all.stragglers.end(), share.stragglers.begin(), share.stragglers.end());
    }
    keep_each_once(all.stragglers);
    return all;
  }

  Snapshot snapshot() {
    const auto [sums, finished, stragglers] = collect();
    Snapshot snapshot;
    snapshot.stragglers = stragglers;
    snapshot.block_sizes = blocks_.sizes();
    snapshot.finished = finished.list();
    for (const Sum sum : sums) {
      snapshot.sums_high.push_back(static_cast<std::uint64_t>(sum >> 64));
      snapshot.sums_low.push_back(static_cast<std::uint64_t>(sum));
    }
    return snapshot;
  }

  const Plan& plan_;
  const RunOptions& options_;
  const Blocks blocks_;
  std::vector<Share> shares_;
  Intervals before_;
  std::uint64_t end_ = 0;  // of the blocks in the part under way
  std::atomic<std::uint64_t> next_{0}, finished_blocks_{0};
  std::atomic<bool> failed_{false};
  std::mutex error_lock_, report_lock_;
  std::exception_ptr error_;
  const Clock::time_point start_ = Clock::now();
  double next_progress_ = 0.5, next_snapshot_ = options_.snapshot_seconds;
};

}  // namespace

bool fits(const Snapshot& snapshot, const Plan& plan, int halvings) {
  if (snapshot.sums_low.size() != plan.sums || snapshot.block_sizes.size() != plan.trees.size()) return false;
  if (std::ranges::find(snapshot.block_sizes, 0U) != snapshot.block_sizes.end()) return false;
  for (const Straggler& s : snapshot.stragglers)
    if (!is_of(s, plan)) return false;
  return snapshot.finished.empty() ||
         snapshot.finished.back().second <= Blocks(plan, snapshot.block_sizes, halvings).count();
}

RunOutcome run(const Plan& plan, const RunOptions& options) { return Runner(plan, options).run(); }

}  // namespace rabiline
