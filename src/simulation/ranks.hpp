#pragma once
// Processes that fly one run together.
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "tally/sums.hpp"

namespace rabiline {

/// Processes that fly one run together, counted from 0, maybe on many machines. Number 0 leads: it alone
/// reads, writes and speaks. All of them make the same calls in the same order.
class Ranks {
 public:
  Ranks() = default;
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  virtual ~Ranks() = default;
  virtual int size() const = 0;
  virtual int rank() const = 0;
  /// Of them, those on this machine.
  virtual int neighbours() const = 0;
  bool leads() const { return rank() == 0; }
  /// What the leader has, to all.
  std::vector<std::string> broadcast(const std::vector<std::string>& of_leader);
  /// What each has, to the leader; others get nothing.
  virtual std::vector<std::string> collect(const std::string& own) = 0;
  /// The sums of all, to the leader; those of others are spent.
  virtual void add_up(Sums&) = 0;
  /// What each has, to all.
  template <class Plain>
  std::vector<Plain> exchange(const Plain& own) {
    std::vector<Plain> all(static_cast<std::size_t>(size()));
    exchange_bytes(&own, sizeof own, all.data());
    return all;
  }
  /// Ends all of them at once.
  [[noreturn]] virtual void give_up(const std::string& why) = 0;

 protected:
  virtual std::string broadcast_bytes(std::string of_leader) = 0;
  virtual void exchange_bytes(const void* own, std::size_t size, void* all) = 0;
};

/// One process by itself.
class Alone final : public Ranks {
 public:
  int size() const override { return 1; }
  int rank() const override { return 0; }
  int neighbours() const override { return 1; }
  std::vector<std::string> collect(const std::string& own) override { return {own}; }
  void add_up(Sums&) override {}
  [[noreturn]] void give_up(const std::string& why) override { throw std::runtime_error(why); }

 private:
  std::string broadcast_bytes(std::string of_leader) override { return of_leader; }
  void exchange_bytes(const void* own, std::size_t size, void* all) override;
};

/// One of several processes could not go on; what had flown by then was handed to the snapshot.
struct RankFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace rabiline
