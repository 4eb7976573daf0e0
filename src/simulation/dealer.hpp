#pragma once
// Who flies what, where several processes fly one run.
#include <cstdint>
#include <vector>

#include "simulation/work.hpp"

namespace rabiline {

/// Places of the row [begin, end), those that have flown before among them.
struct Deal {
  std::uint64_t begin = 0, end = 0;
  std::uint64_t particles = 0;  // still to be flown
  double cost = 0;              // of these, as their trees estimate it
};

/// What a process asks for: nothing, or work of some cost, but no fewer than so many particles.
struct Wish {
  double cost = 0;
  std::uint64_t least = 0;
};

/// Deals the row of particles out from its front. Each process follows what all of them get and so knows its
/// own share without being told.
class Dealer {
 public:
  /// Keeps all three, which must live as long.
  Dealer(const Plan& plan, const ParticleRow& row, const Intervals& flown)
      : plan_(plan), row_(row), flown_(flown) {}
  /// Places [begin, end) are next.
  void open(std::uint64_t begin, std::uint64_t end);
  /// To each its wish; where less is left, shares of it, so that all come to the end together.
  std::vector<Deal> deal(const std::vector<Wish>&);
  bool is_done() const { return next_ >= end_; }

 private:
  Deal next(const Wish&);

  const Plan& plan_;
  const ParticleRow& row_;
  const Intervals& flown_;
  std::uint64_t next_ = 0, end_ = 0;
};

}  // namespace rabiline
