#include "simulation/run.hpp"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <new>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "core/thread_stacks.hpp"
#include "simulation/clock.hpp"
#include "simulation/dealer.hpp"
#include "simulation/flown.hpp"
#include "simulation/tree_runner.hpp"
#include "simulation/work.hpp"

namespace rabiline {
namespace {

/// What a rank tells the others in a beat.
struct Pulse {
  Wish wish;
  std::uint64_t held = 0;   // dealt to it, and not flown yet
  std::uint64_t flown = 0;  // in this run
  bool stop = false, failed = false;
  bool collect = false;  // of the leader: it is time for a snapshot
};

/// One run. In beats of some hundredths of a second the ranks deal the particles out among them; the threads
/// of each take them until none are left or somebody asks to stop.
class Runner {
 public:
  Runner(const Plan& plan, const RunOptions& options)
      : plan_(plan),
        options_(options),
        ranks_(options.ranks == nullptr ? alone_ : *options.ranks),
        row_(plan, options.halvings),
        begin_(options.places(row_.size()).first),
        last_(options.places(row_.size()).second),
        collected_(plan, ranks_.leads() ? options.start : nullptr),
        shares_(static_cast<std::size_t>(options.threads)) {
    if (options.start != nullptr) before_ = Intervals(options.start->finished);
    flown_before_ = flown_ = before_.size();
  }

  RunOutcome run() {
    try {
      return fly();
    } catch (const RankFailure&) {
      throw;
    } catch (const std::exception& error) {
      if (ranks_.size() > 1) ranks_.give_up(error.what());
      throw;
    }
  }

 private:
  RunOutcome fly() {
    int left = options_.halvings;
    for (;; --left) {
      if (!finished_part(left)) fly_part(left);
      if (!finished_part(left) || left == 0 || is_enough(left)) break;
    }
    const bool finished = finished_part(left);
    collect();
    if (options_.snapshot && ranks_.leads()) options_.snapshot(snapshot(finished));
    return {std::move(collected_.sums), std::move(collected_.stragglers), finished, left, {}};
  }

  /// Of the places that belong to the shard.
  std::uint64_t end_of_part(int halvings) const { return std::min(row_.end_of_part(halvings), last_); }
  bool finished_part(int halvings) const { return flown_ >= end_of_part(halvings) - begin_; }
  /// What was flown beyond a part was flown because the part was not enough.
  bool is_enough(int halvings) {
    if (flown_ != end_of_part(halvings) - begin_) return false;
    collect();
    const int enough =
        ranks_.leads() && options_.enough(collected_.sums, collected_.stragglers, halvings) ? 1 : 0;
    return ranks_.exchange(enough).front() != 0;
  }

  void fly_part(int halvings) {
    end_ = end_of_part(halvings);
    dealer_.open(halvings == options_.halvings ? begin_ : row_.end_of_part(halvings + 1), end_);
    no_more_ = false;
    idle_ = 0;
    beat_seconds_ = 0.001;
    {
      std::vector<std::jthread> threads;
      try {
        start(threads);
        while (beat()) wait();
      } catch (...) {
        send_home();
        throw;
      }
      send_home();
    }
    bool failed = false;
    flown_ = flown_before_;
    for (const Pulse& pulse : ranks_.exchange(pulse_now())) {
      flown_ += pulse.flown;
      failed = failed || pulse.failed;
    }
    if (failed) end_with_failure();
  }

  void start(std::vector<std::jthread>& threads) try {
    widen_thread_stacks();
    for (ThreadSums& share : shares_) threads.emplace_back([this, &share] { work(share); });
  } catch (const std::system_error& error) {
    fail(std::make_exception_ptr(std::invalid_argument(
        fmt::format("{} threads cannot be started ({})\n  help: use fewer, with `--threads`",
                    options_.threads, error.what()))));
  }

  /// What the threads have goes on; nothing else does.
  void send_home() {
    const std::lock_guard guard(deal_lock_);
    stock_.clear();
    on_hold_ = false;
    no_more_ = true;
    more_.notify_all();
  }

  /// What others have flown is not lost.
  [[noreturn]] void end_with_failure() {
    collect();
    if (options_.snapshot && ranks_.leads() && flown_ > flown_before_) try {
        options_.snapshot(snapshot(false));
      } catch (...) {  // the first failure is the one to be told
      }
    if (ranks_.size() == 1) std::rethrow_exception(error_);
    std::string own;
    try {
      if (error_) std::rethrow_exception(error_);
    } catch (const std::bad_alloc&) {
      own = "not enough memory";
    } catch (const std::exception& error) {
      own = error.what();
    }
    const std::vector<std::string> all = ranks_.collect(own);
    for (std::size_t rank = 0; rank < all.size(); ++rank)
      if (!all[rank].empty())
        throw RankFailure(fmt::format("rank {} of {} failed: {}", rank, ranks_.size(), all[rank]));
    throw RankFailure("another rank failed");
  }

  bool stop_was_asked() const { return call_.is_made(); }
  bool snapshot_is_due() const {
    return options_.snapshot && ranks_.leads() && news_ && seconds_since(start_) >= next_snapshot_;
  }
  void fail(std::exception_ptr error) {
    const std::lock_guard guard(error_lock_);
    error_ = std::move(error);
    failed_ = true;
  }

  Pulse pulse_now() {
    const std::lock_guard guard(deal_lock_);
    Pulse pulse;
    pulse.held = held_;
    pulse.flown = flown_here_;
    pulse.stop = stop_was_asked();
    pulse.failed = failed_;
    pulse.collect = snapshot_is_due();
    if (ranks_.size() == 1) {
      pulse.wish.cost = 1e30;  // all of it
      return pulse;
    }
    const double seconds = seconds_since(last_pulse_), rate = cost_flown_ / std::max(seconds, 1e-6);
    last_pulse_ = Clock::now();
    cost_flown_ = 0;
    rate_ = std::max(rate, 0.7 * rate_ + 0.3 * rate);
    constexpr double stock_seconds = 0.25;  // five beats
    pulse.wish.cost = std::max(0.0, stock_seconds * rate_ - cost_held_);
    if (held_ == 0) pulse.wish.least = 8 * shares_.size();
    return pulse;
  }

  /// Tells how it stands here, hears how it stands elsewhere, and acts on that as all others do. Whether
  /// there is more to come.
  bool beat() {
    const std::vector<Pulse> all = ranks_.exchange(pulse_now());
    bool stop = false;
    std::uint64_t held = 0;
    std::vector<Wish> wishes;
    flown_ = flown_before_;
    for (const Pulse& pulse : all) {
      stop = stop || pulse.stop || pulse.failed;
      held += pulse.held;
      flown_ += pulse.flown;
      wishes.push_back(pulse.wish);
    }
    if (stop) return false;
    const std::vector<Deal> deals = dealer_.deal(wishes);
    accept(deals[static_cast<std::size_t>(ranks_.rank())]);
    for (const Deal& deal : deals) held += deal.particles;
    if (all.front().collect) collect();
    if (ranks_.leads()) report(all.front().collect);
    return held > 0 || !dealer_.is_done();
  }

  void accept(const Deal& deal) {
    const std::lock_guard guard(deal_lock_);
    if (deal.particles > 0) stock_.push_back(deal);
    held_ += deal.particles;
    cost_held_ = (held_ == deal.particles ? 0 : cost_held_) + deal.cost;
    no_more_ = dealer_.is_done();
    more_.notify_all();
  }

  /// For the next beat; less where threads have nothing to do, or somebody something to tell.
  void wait() {
    beat_seconds_ = std::min(0.05, 2 * beat_seconds_);
    std::unique_lock guard(deal_lock_);
    turn_.wait_for(guard, std::chrono::duration<double>(beat_seconds_),
                   [&] { return idle_ == shares_.size() || failed_ || snapshot_is_due(); });
  }

  /// Particles that nobody has flown, all of one tree; none where first == last.
  ParticleRange next_range(const Pace& pace) {
    std::unique_lock guard(deal_lock_);
    for (;;) {
      more_.wait(guard, [&] { return !on_hold_; });
      if (failed_ || stop_was_asked()) return {};
      while (!stock_.empty()) {
        Deal& deal = stock_.front();
        const auto [begin, end] = before_.gap(deal.begin);
        if (begin >= deal.end) {
          stock_.pop_front();
          continue;
        }
        ParticleRange range = row_.at(begin);
        range.last = std::min({range.last, range.first + (std::min(end, deal.end) - begin),
                               range.first + pace.particles(plan_.trees[range.tree].cost)});
        deal.begin = begin + (range.last - range.first);
        return range;
      }
      if (no_more_) return {};
      ++idle_;
      turn_.notify_one();
      more_.wait(guard);
      --idle_;
    }
  }

  /// One thread's loop. No exception leaves it.
  void work(ThreadSums& share) {
    try {
      TreeRunner runner(options_.isa, options_.batch);
      Pace pace(options_.grain);
      for (;;) {
        const ParticleRange range = next_range(pace);
        const std::uint64_t particles = range.last - range.first;
        if (particles == 0) break;
        const Clock::time_point begin = Clock::now();
        const double cost = plan_.trees[range.tree].cost * static_cast<double>(particles);
        share.fly(runner, plan_, range, call_, pace.seconds(cost) > 0.25);
        pace.took(cost, seconds_since(begin));
        const std::lock_guard guard(deal_lock_);
        held_ -= particles;
        flown_here_ += particles;
        cost_held_ -= cost;
        cost_flown_ += cost;
        news_ = true;
        if (snapshot_is_due()) turn_.notify_one();
      }
    } catch (const CalledOff&) {  // these particles fly when the run goes on
    } catch (...) {
      fail(std::current_exception());
    }
    const std::lock_guard guard(deal_lock_);
    ++idle_;
    turn_.notify_one();
  }

  /// Of the part under way, by what it costs: the laws of a scan take their trees one after the other, and
  /// some are slow. Particles fly about in the order of their places.
  double share_of_work(std::uint64_t flown) const {
    const double before = row_.cost_before(begin_);
    return (row_.cost_before(begin_ + flown) - before) / (row_.cost_before(end_) - before);
  }

  /// By the leader: how far all are, and a snapshot of what was collected.
  void report(bool collected) try {
    const double seconds = seconds_since(start_);
    if (options_.progress && seconds >= next_progress_) {
      const double done = share_of_work(flown_), done_now = done - share_of_work(flown_before_);
      options_.progress({done, seconds, done_now > 0 ? seconds * (1 - done) / done_now : 0});
      next_progress_ = seconds + 0.2;
    }
    if (!collected) return;
    options_.snapshot(snapshot(false));
    next_snapshot_ = seconds_since(start_) + options_.snapshot_seconds;
  } catch (...) {
    fail(std::current_exception());
  }

  /// Threads begin no range meanwhile: they would hardly ever let go of their sums.
  void hold(bool held) {
    const std::lock_guard guard(deal_lock_);
    on_hold_ = held;
    more_.notify_all();
  }
  /// Of all threads of all ranks.
  void collect() {
    news_ = false;
    hold(true);
    collected_.collect(shares_, ranks_);
    hold(false);
  }
  Snapshot snapshot(bool complete) const {
    Snapshot snapshot = collected_.snapshot();
    snapshot.particles = row_.size();
    snapshot.shard = options_.shard;
    snapshot.complete = complete;
    return snapshot;
  }

  const Plan& plan_;
  const RunOptions& options_;
  const Call call_{options_.stop, options_.latest};
  Alone alone_;
  Ranks& ranks_;
  const ParticleRow row_;
  const std::uint64_t begin_, last_;            // of the places that belong to the shard
  Intervals before_;                            // what had flown when this run began
  std::uint64_t flown_before_ = 0, flown_ = 0;  // by then, and by all ranks as of the last beat
  std::uint64_t end_ = 0;                       // of the part under way
  Dealer dealer_{plan_, row_, before_};

  Flown collected_;  // complete at the leader alone

  std::vector<ThreadSums> shares_;
  std::mutex deal_lock_;                    // of all up to the next blank line
  std::condition_variable more_, turn_;     // for the threads, for the beat
  std::deque<Deal> stock_;                  // dealt, and taken by no thread
  bool on_hold_ = false, no_more_ = false;  // will come
  std::size_t idle_ = 0;                    // threads
  std::uint64_t held_ = 0, flown_here_ = 0;
  double cost_held_ = 0, cost_flown_ = 0;  // the latter since the last pulse

  std::mutex error_lock_;
  std::exception_ptr error_;
  std::atomic<bool> failed_{false}, news_{false};  // something has flown since the last snapshot
  const Clock::time_point start_ = Clock::now();
  Clock::time_point last_pulse_ = start_;
  double rate_ = 0, beat_seconds_ = 0;  // [cost/s], [s]
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
