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

/// The screen that a link is, or nullptr.
const Screen* screen_of(const ChainLink&);
/// Whether a stage behind a projection can be booked afterwards: paths, and levels that no field changes any
/// more.
bool can_be_booked(const Stage&);

class Branches {
 public:
  /// Flies what flies of the batch, once in each level that it can be found in, through the chain. `reach`:
  /// these levels as a mask, for each level that a particle is in.
  void fly(const Batch& batch, const std::vector<ChainLink>& chain, const std::vector<std::uint64_t>& reach,
           const Kernels& kernels, const RandomKey& key);
  /// Shares the weights by a projection, and adds what each share comes to, to the sums of the chain; those
  /// begin `shift` behind what the links say.
  void book(const LevelProjection& projection, Sum* sums, std::size_t shift);

 private:
  static constexpr std::size_t capacity = Batch::capacity;
  static std::size_t number(int i) { return static_cast<std::size_t>(i); }
  static constexpr std::uint32_t not_counted = ~std::uint32_t{0};
  static constexpr std::uint16_t not_flown = 0xffff;
  /// How the particles in one level end.
  struct Ends {
    std::array<std::uint16_t, capacity> link;  // where in the chain, or not_flown
    std::array<std::uint8_t, capacity> level;  // in which level
    std::array<std::uint32_t, capacity> bin;   // on a screen, or not_counted
  };
  /// Particles one after the other that were prepared in one level.
  struct Group {
    int begin, end;
    std::size_t prepared;
  };
  /// What ends uncounted at a link, of the particles on one path.
  struct Stop {
    std::size_t path, link, mask;  // masks_ begin there
  };
  /// What one particle has in one bin: the sum over one to all of its paths.
  struct Cell {
    std::uint32_t bin;
    std::uint16_t particle;
    std::uint16_t paths;  // how many; cell_paths_ lists them
  };
  /// Two cells of one particle in one column or one row of bins, and the sum that (a + b)^2 adds 2ab to.
  struct Neighbours {
    std::uint32_t first, second;
    std::size_t sum;
  };
  struct ScreenBook {
    std::size_t link;
    int stretch;       // the link that asks for the levels of what it caught, or -1
    std::size_t hits;  // masks_ begin there, one column for each path
    std::vector<Cell> cells;
    std::vector<std::uint8_t> cell_paths;
    std::vector<Neighbours> neighbours;
  };

  /// What a tally behind the projection sees of each path.
  struct MonitorBook {
    std::size_t link;
    std::vector<std::array<std::uint64_t, capacity>> crossed;  // [path] masks
  };
  struct HistogramBook {
    std::size_t link;
    std::vector<HistogramPlaces> places;  // [path]
  };

  void fly_on(std::size_t path, const Batch& batch, const std::vector<std::uint64_t>& reach);
  void gather(const Batch& batch, int level, const std::vector<std::uint64_t>& reach);
  void look(std::size_t link, std::size_t path);
  void keep_undecided(const Batch& batch);
  void keep(const BatchView& from, int i);
  void find_stops();
  void find_hits();
  static std::vector<Neighbours> neighbours_of(const std::vector<Cell>& cells, const ScreenSums& layout);
  void book_stops(Sum* sums) const;
  void book_screen(const ScreenBook& book, Sum* sums);
  void book_monitor(const MonitorBook& book, Sum* sums) const;
  template <class Weight>
  void book_histogram(const HistogramBook& book, const Weight& weight, Sum* sums) const;
  std::uint64_t share_of(std::size_t path, int k) const {
    return shares_[number(levels_[path]) * number(asked_.view().padded) + number(k)];
  }
  void book_levels(const ScreenBook& book, const LevelSums& by_path, Sum* sums) const;
  std::size_t new_mask();
  std::uint64_t* masks() { return reinterpret_cast<std::uint64_t*>(masks_.data()); }
  const std::uint64_t* masks() const { return reinterpret_cast<const std::uint64_t*>(masks_.data()); }

  std::vector<ChainLink> chain_;
  const Kernels* kernels_ = nullptr;
  RandomKey key_;
  std::vector<int> levels_;             // that are flown: one path each
  std::vector<Ends> ends_;              // of each path
  std::vector<Sum> unused_;             // what the stages themselves would add
  std::vector<std::uint64_t> decided_;  // [link][prepared level] [quanta] that end there whatever the level
  std::vector<Group> groups_;
  std::vector<Stop> stops_;
  std::vector<ScreenBook> screens_;
  std::vector<MonitorBook> monitors_;
  std::vector<HistogramBook> histograms_;
  /// Eight words, aligned as kernels want their columns.
  struct alignas(64) Line {
    std::uint64_t words[8];
  };
  std::vector<Line> masks_;
  Batch flown_;
  std::array<std::uint16_t, capacity> flown_number_{};  // of each of them in the batch
  Batch asked_;                                         // those whose end depends on the level
  std::array<std::uint16_t, capacity> number_{};        // of each of them in the batch
  alignas(64) std::array<std::uint64_t, most_levels * capacity> shares_{}, counts_{};
  alignas(64) std::array<std::uint64_t, capacity> totals_{};
  std::vector<std::uint64_t> scores_;  // of each cell of a screen
};

}  // namespace rabiline
