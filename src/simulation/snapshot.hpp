#pragma once
// Where a run stands: what has flown, and its sums.
#include <algorithm>
#include <compare>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/diagnostics.hpp"
#include "tally/sums.hpp"

namespace rabiline {

/// How far a run is.
struct Progress {
  double done = 0;          // fraction of the work
  double seconds = 0;       // since this run began
  double seconds_left = 0;  // estimate; 0 before anything has flown, too
  /// Where the run ends at a precision: the errors of `detected` and of the line's centre [SI] so far, or 0.
  /// `done` then is that of the part under way.
  double error = 0, centre_error = 0;
};

/// A particle that was too slow or too fast for cells of moments.
struct Straggler {
  std::uint64_t tree, particle;  // of the plan; its number
  auto operator<=>(const Straggler&) const = default;
};

/// Moments of the slowness that a result keeps, from which other scans follow without another flight: where
/// they are a fifth of the file at most; none; of each detector as a whole; of its bins and of tallies.
enum class KeptTransit { if_small, none, totals, images };

/// A share of a run's work that is flown by itself, 1 to `of`.
struct Shard {
  std::uint64_t number = 0, of = 0;  // of none, the whole
  bool is_whole() const { return of == 0; }
  bool exists() const { return is_whole() ? number == 0 : number >= 1 && number <= of; }
  bool operator==(const Shard&) const = default;
  /// Of so many places, those that belong to it.
  std::pair<std::uint64_t, std::uint64_t> places(std::uint64_t all) const {
    if (is_whole()) return {0, all};
    const auto end_of = [&](std::uint64_t k) { return all / of * k + std::min(k, all % of); };
    return {end_of(number - 1), end_of(number)};
  }
};

/// Exact 128-bit sums, of which only those that are not zero are listed: high * 2^64 + low at each place.
struct KeptSums {
  std::uint64_t size = 0;                          // those that are zero included
  std::vector<std::uint64_t> at{}, high{}, low{};  // ascending places
  bool operator==(const KeptSums&) const = default;
};
KeptSums kept(const Sums&);
/// Of so many as its size, which must be reasonable.
Sums sums_of(const KeptSums&);
/// Both of one size.
KeptSums added(const KeptSums&, const KeptSums&);

/// Everything that a run needs to go on: which of its particles have flown, and the exact sums over them.
struct Snapshot {
  std::string fingerprint;      // of the experiment; a snapshot of another one is refused
  std::uint64_t particles = 0;  // of the whole run, of all trees of its plan
  Shard shard;
  bool complete = false;  // whether this is all of the run, or of the shard; known when it is made
  /// Half-open intervals of their places in the row of all particles, ascending and disjoint.
  std::vector<std::pair<std::uint64_t, std::uint64_t>> finished;
  KeptSums sums;
  std::vector<Straggler> stragglers;   // among the finished particles
  std::vector<std::string> arguments;  // of the run
  std::vector<InputText> inputs;
  std::vector<std::string> changes;  // of the inputs, as options
  KeptTransit transit = KeptTransit::if_small;
  std::uint64_t max_memory = 0;  // [bytes] that it may use; 0: what a run may without a word
  std::string begun;             // ISO 8601, when the run began
  double seconds = 0;            // [s] that it took so far

  /// Of its work.
  double done() const {
    std::uint64_t flown = 0;
    for (const auto& [begin, end] : finished) flown += end - begin;
    const auto [begin, end] = shard.places(particles);
    return end == begin ? 1 : static_cast<double>(flown) / static_cast<double>(end - begin);
  }
};

/// The sums of all shards of a run, one after the other in any order.
class Merger {
 public:
  /// `name` says in messages where the shard came from. Throws std::invalid_argument where it is of another
  /// run, was added before, or is not finished.
  void add(const std::string& name, Snapshot shard);
  /// Throws std::invalid_argument where shards are missing, with their numbers.
  Snapshot finish();

 private:
  Snapshot sum_;
  std::vector<std::string> names_;  // of the shards that were added; empty where one is missing
};

}  // namespace rabiline
