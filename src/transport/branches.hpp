#pragma once
// A batch behind a projection that splits weights: one copy in each level is flown to its end once, and the
// sums for every set of level weights are computed from these paths.
#include <memory>
#include <vector>

#include "transport/paths.hpp"
#include "transport/stage.hpp"
#include "transport/transit_book.hpp"

namespace rabiline {

/// One stage behind a projection, where its sums begin, and those of the ledger by prepared level, or 0: for
/// each level what was caught and what ended there.
struct ChainLink {
  const Stage* stage;
  std::size_t sums;
  std::size_t ledger;
};

class Branches {
 public:
  /// Flies what flies of the batch, once in each level that it can be found in, through the chain.
  /// `axis`: of the levels. `reachable`: these levels as a mask, for each level that a particle is in. With a
  /// layout of moments, particles whose slowness is in its cells are left to book_moments().
  void fly(const Batch& batch, const UnitVector& axis, const std::vector<ChainLink>& chain,
           const std::vector<std::uint64_t>& reachable, Isa isa, const RandomKey& key,
           const TransitLayout* layout = nullptr);
  /// Books them for all reweightings at once, and what ends alike in every level, in the sums
  /// of the layout. Whether all were booked.
  bool book_moments(const TransitLayout& layout, const Batch& batch, MomentBuffer&, Sum* sums);
  /// Shares the weights by a projection, and adds what each share comes to, to the sums of the chain; those
  /// begin `shift` behind what the links say.
  void book(const SpinPath& projection, Sum* sums, std::size_t shift);

 private:
  static constexpr std::size_t capacity = Batch::capacity;
  static std::size_t number(int i) { return static_cast<std::size_t>(i); }
  /// What ends uncounted at a link, of the particles on one path.
  struct Stop {
    std::size_t path, link;
    std::vector<std::uint64_t> mask;
    std::vector<PreparedGroup> groups{};  // that have any
  };

  void fly_on(std::size_t path, const Batch& batch, const std::vector<std::uint64_t>& reachable);
  void gather(const Batch& batch, int level, const std::vector<std::uint64_t>& reachable);
  void keep_undecided(const Batch& batch, const TransitLayout*);
  void find_stops();
  void book_stops(Sum* sums) const;
  void book_decided(Sum* sums) const;
  void book_tallies(const PathWeights&, Sum* sums);

  std::vector<ChainLink> chain_;
  std::vector<std::unique_ptr<PathTally>> tallies_;  // [link], null where it keeps nothing
  bool sees_all_ = false;                            // something looks at every particle on its way
  Isa isa_ = Isa::baseline;
  RandomKey key_;
  Paths paths_;
  UnitVector axis_;
  std::vector<Sum> unused_;             // what the stages themselves would add
  std::vector<std::uint64_t> decided_;  // [link][prepared level] [quanta] that end there whatever the level
  std::vector<Stop> stops_;
  std::vector<int> in_cells_;  // particles of the batch that are booked by moments
  TransitBook transits_;
  Batch flown_;
  std::array<std::uint16_t, capacity> flown_number_{};  // of each of them in the batch
  alignas(64) std::array<std::uint64_t, most_levels * capacity> shares_{};
};

}  // namespace rabiline
