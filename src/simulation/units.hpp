#pragma once
// Units of work: blocks of particles through one tree, numbered, and which of them are finished.
#include <cstdint>
#include <utility>
#include <vector>

#include "plan/plan.hpp"

namespace rabiline {

struct Unit {
  std::size_t tree;
  std::uint64_t first, last;  // particle numbers
};

/// Particles in a unit of each tree: as many as cost about most_cost. They follow from costs in floating
/// point, so a run that goes on elsewhere takes those that it began with (Snapshot).
std::vector<std::uint64_t> unit_sizes(const Plan&, double most_cost);

/// All units of a plan in order; the same for every number of threads.
class Units {
 public:
  Units(const Plan&, std::vector<std::uint64_t> sizes);
  std::uint64_t count() const { return begin_.back(); }
  const std::vector<std::uint64_t>& sizes() const { return sizes_; }
  Unit unit(std::uint64_t number) const;

 private:
  const Plan& plan_;
  std::vector<std::uint64_t> sizes_;
  std::vector<std::uint64_t> begin_;  // first unit of each tree, and the number of all
};

/// A set of unit numbers as half-open intervals, ascending and disjoint.
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
