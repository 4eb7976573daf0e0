#pragma once
// Flights that end early: particles may take seconds each, and nobody who stops a run, or asks what one
// costs, waits for them.
#include <atomic>
#include <chrono>
#include <utility>

namespace rabiline {

/// What a flight that is called off throws; of its sums there may be a part.
struct CalledOff {};

/// Calls flights off: by a flag that is set, at a time.
struct Call {
  using Clock = std::chrono::steady_clock;
  const std::atomic<bool>* asked = nullptr;
  Clock::time_point latest = Clock::time_point::max();

  bool is_made() const {
    return (asked != nullptr && asked->load(std::memory_order_relaxed)) ||
           (latest != Clock::time_point::max() && Clock::now() >= latest);
  }
};
inline Call call_after(double seconds) {
  return {nullptr, Call::Clock::now() + std::chrono::duration_cast<Call::Clock::duration>(
                                            std::chrono::duration<double>(seconds))};
}

/// What this thread's flights heed; none where they fly everything to the end.
inline constinit thread_local const Call* call_off = nullptr;

/// Asked once in each step of what may take many.
inline void heed(const Call* call) {
  if (call != nullptr && call->is_made()) [[unlikely]]
    throw CalledOff();
}

/// While it lives, this thread's flights heed the call.
class Heeding {
 public:
  explicit Heeding(const Call& call) : call_(call), before_(std::exchange(call_off, &call_)) {}
  ~Heeding() { call_off = before_; }
  Heeding(const Heeding&) = delete;
  Heeding& operator=(const Heeding&) = delete;

 private:
  const Call call_;
  const Call* before_;
};

}  // namespace rabiline
