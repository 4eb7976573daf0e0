#pragma once
// Flights that end early: particles may take seconds each, and nobody who stops a run waits for them.
#include <atomic>
#include <utility>

namespace rabiline {

/// What a flight that is called off throws; of its sums there may be a part.
struct CalledOff {};

/// Set, calls off what this thread flies; none while it flies everything to the end.
inline constinit thread_local const std::atomic<bool>* call_off = nullptr;

/// Asked once in each step of what may take many.
inline void heed(const std::atomic<bool>* call) {
  if (call != nullptr && call->load(std::memory_order_relaxed)) [[unlikely]]
    throw CalledOff();
}

/// While it lives, this thread's flights heed the call.
class Heeding {
 public:
  explicit Heeding(const std::atomic<bool>* call) : before_(std::exchange(call_off, call)) {}
  ~Heeding() { call_off = before_; }
  Heeding(const Heeding&) = delete;
  Heeding& operator=(const Heeding&) = delete;

 private:
  const std::atomic<bool>* before_;
};

}  // namespace rabiline
