#pragma once
// One block of particles through one tree of the plan.
#include <map>
#include <memory>

#include "plan/plan.hpp"
#include "transport/branches.hpp"

namespace rabiline {

/// Batches for the depth of a tree: a fork flies each branch but the last with a copy.
class TreeRunner {
 public:
  TreeRunner(Isa isa, int batch_size) : isa_(isa), batch_size_(batch_size) {}

  /// Particles [first, last) of the tree, summed into `sums` (the plan's).
  void fly(const PlanTree&, std::uint64_t first, std::uint64_t last, Sums& sums);
  /// Particles of the last flight that were too slow or too fast for cells of moments, once or more often.
  const std::vector<std::uint64_t>& stragglers() const { return stragglers_; }

 private:
  void propagate(const std::vector<PlanNode>&, std::size_t depth, const RandomKey&, Sums&);
  void pass(const PlanNode&, Batch&, const RandomKey&, Sums&);
  /// Adds what was booked as moments to the sums, before it can overflow.
  void flush_moments(Sums&);
  /// Particles behind a projection that splits weights; by classes of their slowness where there are any, for
  /// which they wait until there are enough for a batch.
  void follow_branches(const PlanNode&, Batch&, const RandomKey&, Sums&);
  void follow_class(const PlanNode&, std::size_t number, Batch&, const RandomKey&, Sums&);
  void follow_waiting(const RandomKey&, Sums&);
  void read_levels(const PlanNode&, const Batch&, const RandomKey&, Sums&);
  Batch& batch(std::size_t depth);

  const Isa isa_;
  int batch_size_;
  std::vector<std::unique_ptr<Batch>> batches_;
  const std::unique_ptr<Branches> branches_ = std::make_unique<Branches>();  // large for a stack
  TransitBook transits_;
  Batch outside_;  // what was caught outside the cells of moments
  std::map<const PlanNode*, MomentBuffer> moments_;
  std::map<const PlanNode*, std::vector<Batch>> waiting_;  // [class], one more for what is slower
  std::vector<std::uint64_t> stragglers_;
};

}  // namespace rabiline
