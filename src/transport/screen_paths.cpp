#include "transport/screen_paths.hpp"

#include <algorithm>

#include "transport/stages/score.hpp"

namespace rabiline {

ScreenPaths::ScreenPaths(const Screen& screen) : screen_(screen), layout_(sums_of(screen)) {}

void ScreenPaths::gather(const Paths& paths, std::size_t link, Isa isa) {
  isa_ = isa;
  hits_ = PathMasks(paths.levels.size(), paths.padded());
  counts_ = PathMasks(paths.levels.size() + 1, paths.padded());
  for (std::size_t k = 0; k < paths.count(); ++k) {
    if (paths.asked.view().weight[k] == 0) continue;
    const std::size_t known = cells_.size();
    for (std::size_t path = 0; path < paths.levels.size(); ++path) {
      const std::size_t at = paths.number[k];
      const std::uint32_t bin = paths.ends[path].bin[at];
      if (paths.ends[path].link[at] != link || bin == PathEnds::not_caught) continue;
      hits_.column(path)[k] = ~std::uint64_t{0};
      // Paths of one cell stand one after the other: there are few in a bin.
      auto cell = std::find_if(cells_.begin() + static_cast<std::ptrdiff_t>(known), cells_.end(),
                               [&](const Cell& c) { return c.bin == bin; });
      std::size_t end = cell_paths_.size();
      if (cell == cells_.end())
        cell = cells_.insert(cell, {bin, static_cast<std::uint16_t>(k), 0});
      else
        for (auto behind = cells_.end(); --behind != cell;) end -= behind->paths;
      ++cell->paths;
      cell_paths_.insert(cell_paths_.begin() + static_cast<std::ptrdiff_t>(end),
                         static_cast<std::uint8_t>(path));
    }
    if (cells_.size() > known) scored_.push_back(static_cast<std::uint16_t>(k));
  }
  find_neighbours();
  find_eights();
}

void ScreenPaths::find_eights() {
  eights_.clear();
  first_eight_.assign(1, 0);
  for (std::size_t path = 0; path < hits_.columns(); ++path) {
    const std::uint64_t* hits = hits_.column(path);
    for (std::size_t eight = 0; 8 * eight < hits_.padded(); ++eight)
      if (std::any_of(hits + 8 * eight, hits + 8 * eight + 8, [](std::uint64_t hit) { return hit != 0; }))
        eights_.push_back(static_cast<std::uint16_t>(eight));
    first_eight_.push_back(eights_.size());
  }
}

void ScreenPaths::find_neighbours() {
  for (std::uint32_t second = 1; second < cells_.size(); ++second)
    for (std::uint32_t first = second; first-- > 0 && cells_[first].particle == cells_[second].particle;) {
      const std::size_t a = cells_[first].bin, b = cells_[second].bin;
      if (a / layout_.rows == b / layout_.rows)
        neighbours_.push_back({first, second, layout_.across_column(a / layout_.rows)});
      else if (a % layout_.rows == b % layout_.rows)
        neighbours_.push_back({first, second, layout_.across_row(a % layout_.rows)});
    }
}

/// Sums of squares are of a particle's whole score: in a bin, on the screen, in a level.
void ScreenPaths::add(const Paths& paths, const PathWeights& weights, Sum* sums, Sum* ledger) {
  const BatchView& asked = paths.asked.view();
  const std::size_t all = paths.levels.size();
  // Each setting has sums of its own, which have left the cache since the last batch.
  for (const Cell& cell : cells_) __builtin_prefetch(&sums[ScreenSums::bin(cell.bin)], 1);
  for (std::size_t g = 0; g < group_count; g += 4) __builtin_prefetch(&sums[layout_.group(g)], 1);
  by_path_ = {};
  const ShareCount shares{.shares = weights.shares,
                          .hits = hits_.column(0),
                          .levels = paths.levels.data(),
                          .eights = eights_.data(),
                          .first_eight = first_eight_.data(),
                          .paths = static_cast<int>(all),
                          .padded = asked.padded,
                          .efficiency = screen_.efficiency};
  std::uint64_t* totals = counts_.column(all);
  kernel::count_shares(isa_)(shares, counts_.column(0), totals, by_path_);
  for (std::size_t path = 0; path < all; ++path) caught_.of[path] = counts_.column(path);
  caught_.totals = totals;
  caught_.by_path = &by_path_;
  sums[layout_.total()] += by_path_.q[all];
  sums[layout_.total() + 1] += joined(by_path_.squares_high[all], by_path_.squares_low[all]);
  const std::uint8_t* listed = cell_paths_.data();
  scores_.resize(cells_.size());
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const Cell& cell = cells_[c];
    std::uint64_t q = 0;
    for (int n = 0; n < cell.paths; ++n) q += counts_.column(*listed++)[cell.particle];
    scores_[c] = q;
    sums[ScreenSums::bin(cell.bin)] += q;
    sums[ScreenSums::bin(cell.bin) + 1] += square(q);
  }
  for (const Neighbours& pair : neighbours_)
    sums[pair.sum] += static_cast<Sum>(2 * scores_[pair.first]) * scores_[pair.second];
  auto scores = scored_.begin();
  for (const PreparedGroup& group : paths.groups) {
    std::uint64_t counted = 0, hit = 0;
    for (; scores != scored_.end() && *scores < group.end; ++scores) {
      counted += totals[*scores];
      sums[layout_.group(asked.particle[*scores] % group_count)] += totals[*scores];
    }
    if (screen_.efficiency != 1)
      for (std::size_t path = 0; path < all; ++path)
        for (int i = group.begin; i < group.end; ++i) hit += weights.of[path][i] & hits_.column(path)[i];
    const std::uint64_t lost = screen_.efficiency != 1 ? hit - counted : 0;
    sums[ScreenSums::lost()] += lost;
    if (ledger == nullptr) continue;
    ledger[2 * group.prepared] += counted;
    ledger[2 * group.prepared + 1] += lost;
  }
}

}  // namespace rabiline
