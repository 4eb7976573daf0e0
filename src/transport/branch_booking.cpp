// One way to share the weights of a batch over the levels behind a projection.
#include <algorithm>

#include "transport/branches.hpp"

namespace rabiline {

void Branches::book(const LevelProjection& projection, Sum* sums, std::size_t shift) {
  sums += shift;
  const BatchView& asked = asked_.view();
  if (asked.count > 0) {
    kernels_->outcomes(question_of(projection, key_), asked, asked.weight, shares_.data());
    book_stops(sums);
    for (const ScreenBook& screen : screens_) book_screen(screen, sums);
    for (const MonitorBook& monitor : monitors_) book_monitor(monitor, sums);
    for (const HistogramBook& histogram : histograms_)
      if (!std::get<Histogram>(*chain_[histogram.link].stage).caught)
        book_histogram(
            histogram, [&](std::size_t path, int k) { return share_of(path, k); }, sums);
  }
  for (std::size_t k = 0; k < chain_.size(); ++k) {
    const Screen* screen = screen_of(chain_[k]);
    const std::size_t at = chain_[k].sums + (screen != nullptr ? sums_of(*screen).lost() : 0);
    for (std::size_t level = 0; level < most_levels; ++level) {
      const std::uint64_t q = decided_[k * most_levels + level];
      if (q == 0) continue;
      sums[at] += q;
      if (chain_[k].ledger != 0) sums[chain_[k].ledger + 2 * level + 1] += q;
    }
  }
}

/// Weights of a batch add up to less than 2^64.
void Branches::book_stops(Sum* sums) const {
  const std::size_t padded = number(asked_.view().padded);
  for (const Stop& stop : stops_) {
    const std::uint64_t* shares = &shares_[number(levels_[stop.path]) * padded];
    const std::uint64_t* ends_here = masks() + stop.mask;
    const ChainLink& link = chain_[stop.link];
    const Screen* screen = screen_of(link);
    const std::size_t at = link.sums + (screen != nullptr ? sums_of(*screen).lost() : 0);
    for (const Group& group : groups_) {
      std::uint64_t q = 0;
      for (int i = group.begin; i < group.end; ++i) q += shares[i] & ends_here[i];
      sums[at] += q;
      if (link.ledger != 0) sums[link.ledger + 2 * group.prepared + 1] += q;
    }
  }
}

/// Sums of squares are of a particle's whole score: in a bin, on the screen, in a level.
void Branches::book_screen(const ScreenBook& book, Sum* sums) {
  const BatchView& asked = asked_.view();
  const std::size_t padded = number(asked.padded);
  const ChainLink& link = chain_[book.link];
  const Screen& screen = *screen_of(link);
  const ScreenSums layout = sums_of(screen);
  Sum* own = sums + link.sums;
  LevelSums by_path;
  const ShareCount shares{shares_.data(), masks() + book.hits,
                          levels_.data(), static_cast<int>(levels_.size()),
                          asked.padded,   screen.efficiency};
  kernels_->count_shares(shares, counts_.data(), totals_.data(), by_path);
  own[layout.total()] += by_path.q[levels_.size()];
  own[layout.total() + 1] +=
      joined(by_path.squares_high[levels_.size()], by_path.squares_low[levels_.size()]);
  const std::uint8_t* listed = book.cell_paths.data();
  scores_.resize(book.cells.size());
  for (std::size_t c = 0; c < book.cells.size(); ++c) {
    const Cell& cell = book.cells[c];
    std::uint64_t q = 0;
    for (int n = 0; n < cell.paths; ++n) q += counts_[*listed++ * padded + cell.particle];
    scores_[c] = q;
    own[layout.bin(cell.bin)] += q;
    own[layout.bin(cell.bin) + 1] += static_cast<Sum>(q) * q;
  }
  for (const Neighbours& pair : book.neighbours)
    own[pair.sum] += static_cast<Sum>(2 * scores_[pair.first]) * scores_[pair.second];
  for (const Group& group : groups_) {
    std::uint64_t counted = 0, hit = 0;
    for (int i = group.begin; i < group.end; ++i) {
      counted += totals_[number(i)];
      own[layout.group(asked.particle[i] % group_count)] += totals_[number(i)];
    }
    if (screen.efficiency != 1)
      for (std::size_t n = 0; n < levels_.size(); ++n)
        for (int i = group.begin; i < group.end; ++i)
          hit +=
              shares_[number(levels_[n]) * padded + number(i)] & masks()[book.hits + n * padded + number(i)];
    const std::uint64_t lost = screen.efficiency != 1 ? hit - counted : 0;
    own[layout.lost()] += lost;
    if (link.ledger == 0) continue;
    sums[link.ledger + 2 * group.prepared] += counted;
    sums[link.ledger + 2 * group.prepared + 1] += lost;
  }
  if (book.stretch >= 0) book_levels(book, by_path, sums);
  const auto counted = [&](std::size_t path, int k) { return counts_[path * padded + number(k)]; };
  for (const HistogramBook& histogram : histograms_) {
    const auto& stage = std::get<Histogram>(*chain_[histogram.link].stage);
    if (stage.caught && stage.part == screen.part) book_histogram(histogram, counted, sums);
  }
}

void Branches::book_monitor(const MonitorBook& book, Sum* sums) const {
  const BatchView& asked = asked_.view();
  Sum* own = sums + chain_[book.link].sums;
  for (int k = 0; k < asked.count; ++k) {
    std::uint64_t q = 0;
    for (std::size_t path = 0; path < levels_.size(); ++path)
      q += share_of(path, k) & book.crossed[path][number_[number(k)]];
    own[CensusSums::total()] += q;
    own[CensusSums::total() + 1] += static_cast<Sum>(q) * q;
    own[CensusSums::group(asked.particle[k] % group_count)] += q;
  }
}

/// `weight(path, k)` is what counts of a particle's share on a path.
template <class Weight>
void Branches::book_histogram(const HistogramBook& book, const Weight& weight, Sum* sums) const {
  const HistogramSums layout = sums_of(std::get<Histogram>(*chain_[book.link].stage));
  const BatchView& asked = asked_.view();
  Sum* own = sums + chain_[book.link].sums;
  for (int k = 0; k < asked.count; ++k) {
    const std::size_t at = number_[number(k)];
    std::array<std::uint32_t, most_levels> bins{};
    std::array<std::uint64_t, most_levels> scores{};
    std::size_t found = 0;
    for (std::size_t path = 0; path < levels_.size(); ++path) {
      const std::uint32_t bin = book.places[path].bin[at];
      const std::uint64_t q = bin == HistogramPlaces::nowhere ? 0 : weight(path, k);
      if (q == 0) continue;
      std::size_t cell = 0;
      while (cell < found && bins[cell] != bin) ++cell;
      if (cell == found) bins[found++] = bin;
      scores[cell] += q;
      if (bin == HistogramPlaces::beyond) continue;
      for (std::size_t axis = 0; axis < layout.axes; ++axis) {
        Sum* moments = own + layout.moments(axis, asked.particle[k] % moment_groups);
        const Sum u = book.places[path].steps[axis][at];
        moments[0] += q;
        moments[1] += q * u;
        moments[2] += q * u * u;
      }
    }
    for (std::size_t cell = 0; cell < found; ++cell) add_score(layout, bins[cell], scores[cell], own);
  }
}

void Branches::book_levels(const ScreenBook& book, const LevelSums& by_path, Sum* sums) const {
  const ChainLink& asks = chain_[number(book.stretch)];
  const LevelLayout layout{number(std::get<SpinStretch>(*asks.stage).levels)};
  Sum* own = sums + asks.sums;
  const bool path_is_level = std::none_of(chain_.begin(), chain_.end(), [](const ChainLink& link) {
    return std::holds_alternative<LevelProjection>(*link.stage);
  });
  if (path_is_level) {
    for (std::size_t path = 0; path < levels_.size(); ++path) {
      const std::size_t level = number(levels_[path]);
      own[layout.q(level)] += by_path.q[path];
      own[layout.squares(level)] += joined(by_path.squares_high[path], by_path.squares_low[path]);
      if (layout.has_products())
        own[layout.products(level)] += joined(by_path.products_high[path], by_path.products_low[path]);
    }
    return;
  }
  // Another projection further on has drawn levels along each path.
  const std::size_t padded = number(asked_.view().padded);
  for (std::size_t k = 0; k < number(asked_.view().count); ++k) {
    if (totals_[k] == 0) continue;
    std::array<std::uint64_t, most_levels> found{};
    for (std::size_t path = 0; path < levels_.size(); ++path)
      found[ends_[path].level[number_[k]]] += counts_[path * padded + k];
    for (std::size_t level = 0; level < layout.levels; ++level) {
      own[layout.q(level)] += found[level];
      own[layout.squares(level)] += static_cast<Sum>(found[level]) * found[level];
      if (layout.has_products()) own[layout.products(level)] += static_cast<Sum>(found[level]) * totals_[k];
    }
  }
}

}  // namespace rabiline
