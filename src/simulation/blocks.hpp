#pragma once
// The work of a run: numbered blocks of particles through one tree each, and which of them are finished.
#include <cstdint>
#include <utility>
#include <vector>

#include "plan/plan.hpp"

namespace rabiline {

struct Block {
  std::size_t tree;
  std::uint64_t first, last;  // particle numbers
};

/// Particles in a block of each tree: as many as cost about most_cost. They follow from costs in floating
/// point, so a run that goes on elsewhere takes those that it began with (Snapshot).
std::vector<std::uint64_t> block_sizes(const Plan&, double most_cost);

/// A run may stop when so many halvings are left: a part of its particles has then flown, of every tree
/// alike.
std::uint64_t last_of_part(const PlanTree&, int halvings);
Plan part_of(const Plan&, int halvings);
/// How often a run with so many particles may be halved, so that errors still are errors: at least 1000 fly.
int most_halvings(std::uint64_t particles);

/// All blocks of a plan in order, one part after the other; the same for every number of threads.
class Blocks {
 public:
  Blocks(const Plan&, std::vector<std::uint64_t> sizes, int halvings = 0);
  std::uint64_t count() const { return begin_.back(); }
  /// Of the blocks in a part.
  std::uint64_t end_of_part(int halvings) const;
  const std::vector<std::uint64_t>& sizes() const { return sizes_; }
  Block block(std::uint64_t number) const;

 private:
  /// Particles of a tree that this part adds to those before it.
  std::pair<std::uint64_t, std::uint64_t> added(std::size_t part, std::size_t tree) const;

  const Plan& plan_;
  std::vector<std::uint64_t> sizes_;
  int halvings_;
  std::vector<std::uint64_t> begin_;  // first block of each tree in each part, and the number of all
};

/// A set of block numbers as half-open intervals, ascending and disjoint.
class Intervals {
 public:
  Intervals() = default;
  explicit Intervals(std::vector<std::pair<std::uint64_t, std::uint64_t>> intervals)
      : intervals_(std::move(intervals)) {}
  void insert(std::uint64_t number);
  void insert(const Intervals&);
  bool contains(std::uint64_t number) const;
  std::uint64_t size() const;
  const std::vector<std::pair<std::uint64_t, std::uint64_t>>& list() const { return intervals_; }

 private:
  std::vector<std::pair<std::uint64_t, std::uint64_t>> intervals_;
};

}  // namespace rabiline
