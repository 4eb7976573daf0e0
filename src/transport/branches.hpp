#pragma once
// A batch behind a projection: one copy in each level is flown to its end once, and every way to share the
// weights over the levels is booked from that.
#include <array>
#include <cstdint>
#include <vector>

#include "transport/stages.hpp"

namespace rabiline {

/// One stage behind a projection, where its sums begin, and those of the ledger by prepared level, or 0: for
/// each level what was caught and what ended there.
struct ChainLink {
  const Stage* stage;
  std::size_t sums;
  std::size_t ledger;
};

/// Whether a stage behind a projection can be booked afterwards: paths, and levels that no field changes any
/// more.
bool can_be_booked(const Stage&);

class Branches {
 public:
  /// Flies what flies of the batch, once in each level of the mask, through the chain.
  void fly(const Batch& batch, const std::vector<ChainLink>& chain, std::uint64_t levels,
           const Kernels& kernels, const RandomKey& key);
  /// Shares the weights by a projection, and adds what each share comes to, to the sums of the chain; those
  /// begin `shift` behind what the links say.
  void book(const LevelProjection& projection, Sum* sums, std::size_t shift);

 private:
  static constexpr std::size_t capacity = Batch::capacity;
  /// How the particles in one level end.
  struct Ends {
    std::array<std::uint16_t, capacity> link;  // where in the chain
    std::array<std::uint8_t, capacity> level;  // in which level
    std::array<std::uint32_t, capacity> bin;   // on a screen, or not_counted
  };
  static constexpr std::uint32_t not_counted = ~std::uint32_t{0};
  /// A share that a screen has counted.
  struct Caught {
    std::uint64_t q;
    std::uint32_t bin;
    std::uint16_t link;
    std::uint8_t level;
  };

  void fly_in(int level, const Batch& batch);
  void keep_undecided(const Batch& batch);
  int count_shares(int i, Caught* caught);
  void tally(int i, const Caught* caught, int count, Sum* sums);

  std::vector<ChainLink> chain_;
  std::vector<int> stretch_;  // for each link that is a screen, the link that asks for its levels, or -1
  const Kernels* kernels_ = nullptr;
  RandomKey key_;
  std::vector<int> levels_;                      // that are flown
  std::vector<Ends> ends_;                       // of each level
  std::vector<Sum> unused_;                      // what the stages themselves would add
  std::vector<std::uint64_t> decided_;           // [quanta] that end at each link whatever the level
  std::vector<std::uint64_t> decided_by_level_;  // [link][prepared level] the same
  std::vector<std::uint64_t> ended_, lost_;      // [quanta] at each link in one way
  std::vector<std::uint64_t> ledger_;            // [link][prepared level][caught, ended] of one way
  Batch flown_;
  Batch asked_;                                   // those whose end depends on the level
  std::array<std::uint16_t, capacity> number_{};  // of each of them in the batch
  alignas(64) std::array<std::uint64_t, most_levels * capacity> shares_{};
};

}  // namespace rabiline
