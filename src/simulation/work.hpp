#pragma once
// The work of a run: its particles in one row, and which of them have flown.
#include <cstdint>
#include <utility>
#include <vector>

#include "plan/plan.hpp"

namespace rabiline {

/// A run may stop when so many halvings are left: a part of its particles has then flown, of every tree
/// alike.
std::uint64_t last_of_part(const PlanTree&, int halvings);
Plan part_of(const Plan&, int halvings);
/// How often a run with so many particles may be halved, so that errors still are errors: at least 1000 fly.
int most_halvings(std::uint64_t particles);

/// Particles [first, last) of a tree, and the place of the first one in the row.
struct ParticleRange {
  std::uint64_t place;
  std::size_t tree;
  std::uint64_t first, last;
};

/// All particles of a plan, one part after the other, in each part tree after tree: the same row on every
/// machine.
class ParticleRow {
 public:
  explicit ParticleRow(const Plan&, int halvings = 0);
  std::uint64_t size() const { return begin_.back(); }
  /// Of the places in a part.
  std::uint64_t end_of_part(int halvings) const;
  /// From a place to the end of its tree in its part.
  ParticleRange at(std::uint64_t place) const;
  /// What all places before one take by the plan's estimate [s].
  double cost_before(std::uint64_t place) const;

 private:
  /// Particles of a tree that this part adds to those before it.
  std::pair<std::uint64_t, std::uint64_t> added(std::size_t part, std::size_t tree) const;

  const Plan& plan_;
  int halvings_;
  std::vector<std::uint64_t> begin_;  // first place of each tree in each part, and the number of all
};

/// A set of places as half-open intervals, ascending and disjoint.
class Intervals {
 public:
  using List = std::vector<std::pair<std::uint64_t, std::uint64_t>>;
  Intervals() = default;
  explicit Intervals(List intervals) : intervals_(std::move(intervals)) {}
  void insert(std::uint64_t begin, std::uint64_t end);
  void insert(const Intervals&);
  /// The first places at or behind this one that are not in the set.
  std::pair<std::uint64_t, std::uint64_t> gap(std::uint64_t from) const;
  std::uint64_t size() const;
  const List& list() const { return intervals_; }

 private:
  List intervals_;
};

/// How many particles a thread takes at once. Costs are estimated before the run, so it begins with eight and
/// goes by what the last ones took.
class Pace {
 public:
  explicit Pace(double seconds) : seconds_(seconds) {}
  /// Of a tree whose particles cost so much.
  std::uint64_t particles(double cost) const;
  /// What work of this cost is expected to take [s].
  double seconds(double cost) const { return per_cost_ * cost; }
  void took(double cost, double seconds);

 private:
  double seconds_;         // wanted
  double last_ = 0;        // cost of what was taken last
  double per_cost_ = 1.0;  // seconds that it took for each of the estimate
};

}  // namespace rabiline
