#include "simulation/run.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "simulation/walk.hpp"
#include "simulation/work.hpp"

namespace rabiline {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// What one thread has done. The lock is held while particles fly, so that a snapshot sees whole stretches
/// only.
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

/// One run: threads take particles until none are left or somebody asks to stop.
class Runner {
 public:
  Runner(const Plan& plan, const RunOptions& options)
      : plan_(plan),
        options_(options),
        row_(plan, options.halvings),
        begin_(options.shard.places(row_.size()).first),
        last_(options.shard.places(row_.size()).second),
        shares_(static_cast<std::size_t>(options.threads)) {
    for (Share& share : shares_) share.sums.resize(plan.sums);
    if (options.start != nullptr) {
      before_ = finished_ = Intervals(options.start->finished);
      shares_.front().sums = sums_of(options.start->sums);
      shares_.front().stragglers = options.start->stragglers;
    }
    flown_ = before_.size();
  }

  RunOutcome run() {
    int left = options_.halvings;
    for (;; --left) {
      if (!finished_part(left)) fly_part(left);
      if (!finished_part(left) || left == 0 || is_enough(left)) break;
    }
    const bool finished = finished_part(left);
    if (options_.snapshot) options_.snapshot(snapshot(finished));
    RunOutcome out{std::move(shares_.front().sums), std::move(shares_.front().stragglers), finished, left};
    for (std::size_t i = 1; i < shares_.size(); ++i) {
      add(out.sums, std::exchange(shares_[i].sums, {}));
      out.stragglers.insert(out.stragglers.end(), shares_[i].stragglers.begin(), shares_[i].stragglers.end());
    }
    keep_each_once(out.stragglers);
    return out;
  }

 private:
  /// Of the places that belong to the shard.
  std::uint64_t end_of_part(int halvings) const { return std::min(row_.end_of_part(halvings), last_); }
  bool finished_part(int halvings) const { return flown_ >= end_of_part(halvings) - begin_; }
  /// What was flown beyond a part was flown because the part was not enough.
  bool is_enough(int halvings) {
    return flown_ == end_of_part(halvings) - begin_ && options_.enough(collect().sums, halvings);
  }
  void fly_part(int halvings) {
    end_ = end_of_part(halvings);
    next_ = halvings == options_.halvings ? begin_ : row_.end_of_part(halvings + 1);
    {
      std::vector<std::jthread> others;
      try {
        for (std::size_t i = 1; i < shares_.size(); ++i) others.emplace_back([this, i] { work(shares_[i]); });
        work(shares_.front());
      } catch (const std::system_error& error) {
        failed_ = true;
        throw std::invalid_argument(
            fmt::format("{} threads cannot be started ({})\n  help: use fewer, with `--threads`",
                        options_.threads, error.what()));
      }
    }
    if (error_) std::rethrow_exception(error_);
  }
  bool stopped() const { return failed_ || (options_.stop != nullptr && *options_.stop); }

  /// The next particles that nobody has flown, all of one tree; none where first == last.
  Stretch take(const Pace& pace) {
    const std::lock_guard guard(deal_lock_);
    const auto [begin, end] = before_.gap(next_);
    if (begin >= end_) return {};
    Stretch stretch = row_.at(begin);
    const std::uint64_t most = std::min(end_, end) - begin;
    stretch.last = std::min(
        {stretch.last, stretch.first + most, stretch.first + pace.particles(plan_.trees[stretch.tree].cost)});
    next_ = begin + (stretch.last - stretch.first);
    return stretch;
  }

  /// One thread's loop. No exception leaves it.
  void work(Share& share) {
    try {
      Walker walker(options_.isa, options_.batch);
      Pace pace(options_.grain);
      while (!stopped()) {
        const Stretch stretch = take(pace);
        const std::uint64_t particles = stretch.last - stretch.first;
        if (particles == 0) return;
        const Clock::time_point begin = Clock::now();
        const PlanTree& tree = plan_.trees[stretch.tree];
        {
          const std::lock_guard guard(share.lock);
          walker.fly(tree, stretch.first, stretch.last, share.sums);
          share.finished.insert(stretch.place, stretch.place + particles);
          for (const std::uint64_t particle : walker.stragglers())
            share.stragglers.push_back({stretch.tree, particle});
        }
        flown_ += particles;
        pace.took(tree.cost * static_cast<double>(particles), seconds_since(begin));
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
      const double all = static_cast<double>(end_ - begin_), done = static_cast<double>(flown_) / all;
      const double done_now = done - static_cast<double>(before_.size()) / all;
      options_.progress({done, seconds, done_now > 0 ? seconds * (1 - done) / done_now : 0});
      next_progress_ = seconds + 0.2;
    }
    if (options_.snapshot && seconds >= next_snapshot_) {
      options_.snapshot(snapshot(false));
      next_snapshot_ = seconds_since(start_) + options_.snapshot_seconds;
    }
  }

  /// Of all threads and of the runs before. By one thread at a time.
  struct Collected {
    Sums sums;
    std::vector<Straggler> stragglers;
  };
  Collected collect() {
    Collected all{Sums(plan_.sums), {}};
    for (Share& share : shares_) {
      const std::lock_guard guard(share.lock);
      add(all.sums, share.sums);
      finished_.insert(std::exchange(share.finished, {}));
      all.stragglers.insert(all.stragglers.end(), share.stragglers.begin(), share.stragglers.end());
    }
    keep_each_once(all.stragglers);
    return all;
  }

  Snapshot snapshot(bool complete) {
    auto [sums, stragglers] = collect();
    Snapshot snapshot;
    snapshot.stragglers = std::move(stragglers);
    snapshot.particles = row_.size();
    snapshot.shard = options_.shard;
    snapshot.complete = complete;
    snapshot.finished = finished_.list();
    snapshot.sums = kept(sums);
    return snapshot;
  }

  const Plan& plan_;
  const RunOptions& options_;
  const ParticleRow row_;
  const std::uint64_t begin_, last_;  // of the places that belong to the shard
  std::vector<Share> shares_;
  Intervals before_;    // what had flown when this run began
  Intervals finished_;  // and what was found to have flown since
  std::mutex deal_lock_;
  std::uint64_t end_ = 0, next_ = 0;  // of the part under way
  std::atomic<std::uint64_t> flown_{0};
  std::atomic<bool> failed_{false};
  std::mutex error_lock_, report_lock_;
  std::exception_ptr error_;
  const Clock::time_point start_ = Clock::now();
  double next_progress_ = 0.5, next_snapshot_ = options_.snapshot_seconds;
};

}  // namespace

bool fits(const Snapshot& snapshot, const Plan& plan) {
  if (snapshot.sums.size != plan.sums) return false;
  std::uint64_t particles = 0;
  for (const PlanTree& tree : plan.trees) particles += tree.last - tree.first;
  if (snapshot.particles != particles) return false;
  for (const Straggler& s : snapshot.stragglers)
    if (!is_of(s, plan)) return false;
  const auto [begin, end] = snapshot.shard.places(particles);
  return snapshot.finished.empty() ||
         (snapshot.finished.front().first >= begin && snapshot.finished.back().second <= end);
}

RunOutcome run(const Plan& plan, const RunOptions& options) { return Runner(plan, options).run(); }

}  // namespace rabiline
