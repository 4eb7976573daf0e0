#pragma once
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "core/processors.hpp"
#include "core/thread_stacks.hpp"

namespace rabiline {

/// Calls work(0) to work(count - 1) on so many threads, or as many as the process may use where that is 0;
/// each must leave the others alone. Where threads cannot be made, fewer will do. One of the exceptions that
/// were thrown is thrown in the end.
template <class Work>
void in_parallel(std::size_t count, int threads, const Work& work) {
  std::exception_ptr error;
  std::mutex lock;
  std::atomic<std::size_t> next{0};
  const auto take = [&] {
    for (std::size_t i = next++; i < count; i = next++) try {
        work(i);
      } catch (...) {
        const std::lock_guard guard(lock);
        error = std::current_exception();
      }
  };
  {
    const auto workers = static_cast<std::size_t>(threads > 0 ? threads : processors());
    widen_thread_stacks();
    std::vector<std::jthread> others;
    try {
      while (others.size() + 1 < std::min(workers, count)) others.emplace_back(take);
    } catch (const std::system_error&) {
    }
    take();
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace rabiline
