#include "transport/branches.hpp"

#include <algorithm>

namespace rabiline {
namespace {

constexpr std::uint64_t yes = ~std::uint64_t{0};

const Screen* screen_of(const ChainLink& link) {
  const auto* score = std::get_if<Score>(link.stage);
  return score != nullptr ? &score->screen : nullptr;
}

std::size_t number(int i) { return static_cast<std::size_t>(i); }

}  // namespace

bool can_be_booked(const Stage& stage) {
  if (const auto* histogram = std::get_if<Histogram>(&stage))
    return histogram->zones.empty() && histogram->transitions == nullptr &&
           std::all_of(histogram->axes.begin(), histogram->axes.end(), [](const HistogramAxis& axis) {
             return axis.quantity != Quantity::spin || (axis.direction[0] == 0 && axis.direction[1] == 0);
           });
  if (const auto* stretch = std::get_if<SpinStretch>(&stage))
    return stretch->zones.empty() && stretch->transitions == nullptr;
  return std::holds_alternative<Drift>(stage) || std::holds_alternative<Passage>(stage) ||
         std::holds_alternative<LevelProjection>(stage) || std::holds_alternative<Deflection>(stage) ||
         std::holds_alternative<Steering>(stage) || std::holds_alternative<Score>(stage) ||
         std::holds_alternative<Exit>(stage) || std::holds_alternative<Census>(stage);
}

// ---- paths ----

void Branches::fly(const Batch& batch, const std::vector<ChainLink>& chain, std::uint64_t levels,
                   const Kernels& kernels, const RandomKey& key) {
  chain_ = chain;
  kernels_ = &kernels;
  key_ = key;
  std::size_t most = 0;
  for (const ChainLink& link : chain) most = std::max(most, sums_needed(*link.stage));
  unused_.assign(most, 0);
  levels_.clear();
  for (int level = 0; level < most_levels; ++level)
    if ((levels >> level & 1) != 0) levels_.push_back(level);
  ends_.resize(levels_.size());
  monitors_.clear();
  histograms_.clear();
  for (std::size_t link = 0; link < chain.size(); ++link) {
    if (std::holds_alternative<Census>(*chain[link].stage))
      monitors_.push_back({link, std::vector<std::array<std::uint64_t, capacity>>(levels_.size())});
    if (std::holds_alternative<Histogram>(*chain[link].stage))
      histograms_.push_back({link, std::vector<HistogramPlaces>(levels_.size())});
  }
  for (const int level : levels_) fly_in(level, batch);
  keep_undecided(batch);
  masks_.clear();
  find_stops();
  find_hits();
}

void Branches::fly_in(int level, const Batch& batch) {
  const auto path =
      static_cast<std::size_t>(std::find(levels_.begin(), levels_.end(), level) - levels_.begin());
  Ends& ends = ends_[path];
  flown_.copy_from(batch);
  BatchView& b = flown_.view();
  std::fill_n(b.level, b.padded, static_cast<std::uint64_t>(level));
  std::fill_n(b.sx, b.padded, 0.0);
  std::fill_n(b.sy, b.padded, 0.0);
  std::fill_n(b.sz, b.padded, 1.0);
  std::array<std::uint64_t, capacity> flying;
  for (std::size_t k = 0; k < chain_.size(); ++k) {
    if (only_reads(*chain_[k].stage)) {
      look(k, path);
      continue;
    }
    std::copy_n(b.flying, b.count, flying.begin());
    Flight flight{*kernels_, key_, flown_, unused_.data()};
    advance(*chain_[k].stage, flight);
    const bool is_screen = screen_of(chain_[k]) != nullptr;
    for (std::size_t i = 0; i < number(b.count); ++i) {
      if (flying[i] == 0 || b.flying[i] != 0) continue;
      ends.link[i] = static_cast<std::uint8_t>(k);
      ends.level[i] = static_cast<std::uint8_t>(b.level[i]);
      ends.bin[i] = is_screen ? static_cast<std::uint32_t>(b.scratch[i]) : not_counted;
    }
  }
}

/// What a tally sees of the particles on a path where they are now.
void Branches::look(std::size_t link, std::size_t path) {
  Flight flight{*kernels_, key_, flown_, unused_.data()};
  for (HistogramBook& book : histograms_)
    if (book.link == link) find_places(std::get<Histogram>(*chain_[link].stage), flight, book.places[path]);
  for (MonitorBook& book : monitors_) {
    if (book.link != link) continue;
    const BatchView& b = flown_.view();
    alignas(64) std::uint64_t weights[capacity];
    kernels_->cross(std::get<Census>(*chain_[link].stage).face, b, weights);
    for (std::size_t i = 0; i < number(b.count); ++i) book.crossed[path][i] = weights[i] != 0 ? yes : 0;
  }
}

/// Particles that end alike in every level, and are not counted by a screen, are decided. The others are put
/// together by the level that they were prepared in.
void Branches::keep_undecided(const Batch& batch) {
  const BatchView& from = batch.view();
  decided_.assign(chain_.size() * most_levels, 0);
  std::array<std::vector<int>, most_levels> undecided;
  const Ends& first = ends_.front();
  for (int i = 0; i < from.count; ++i) {
    if (from.flying[i] == 0) continue;
    const std::size_t at = number(i);
    const bool alike = std::all_of(ends_.begin(), ends_.end(), [&](const Ends& e) {
      return e.link[at] == first.link[at] && e.bin[at] == not_counted;
    });
    if (alike && monitors_.empty())
      decided_[first.link[at] * most_levels + from.prepared[i]] += from.weight[i];
    else
      undecided[from.prepared[i]].push_back(i);
  }
  BatchView& to = asked_.view();
  to.y = from.y;
  to.count = 0;
  groups_.clear();
  for (std::size_t prepared = 0; prepared < most_levels; ++prepared) {
    if (undecided[prepared].empty()) continue;
    const int begin = to.count;
    for (const int i : undecided[prepared]) keep(from, i);
    groups_.push_back({begin, to.count, prepared});
  }
  // Whole lanes: what fills them up weighs nothing.
  to.padded = (to.count + 7) / 8 * 8;
  const int count = to.count;
  while (to.count < to.padded) {
    keep(from, number_[0]);
    to.weight[to.count - 1] = 0;
  }
  to.count = count;
}

void Branches::keep(const BatchView& from, int i) {
  BatchView& to = asked_.view();
  const int k = to.count++;
  number_[number(k)] = static_cast<std::uint16_t>(i);
  for (const auto column : {&BatchView::vy, &BatchView::t, &BatchView::sx, &BatchView::sy, &BatchView::sz})
    (to.*column)[k] = (from.*column)[i];
  for (const auto column : {&BatchView::level, &BatchView::weight, &BatchView::particle})
    (to.*column)[k] = (from.*column)[i];
}

std::size_t Branches::new_mask() {
  masks_.resize(masks_.size() + number(asked_.view().padded), 0);
  return masks_.size() - number(asked_.view().padded);
}

void Branches::find_stops() {
  stops_.clear();
  for (std::size_t path = 0; path < levels_.size(); ++path) {
    const std::size_t known = stops_.size();
    for (std::size_t k = 0; k < number(asked_.view().count); ++k) {
      const std::size_t at = number_[k], link = ends_[path].link[at];
      if (ends_[path].bin[at] != not_counted) continue;
      auto stop = std::find_if(stops_.begin() + static_cast<std::ptrdiff_t>(known), stops_.end(),
                               [&](const Stop& s) { return s.link == link; });
      if (stop == stops_.end()) stop = stops_.insert(stops_.end(), {path, link, new_mask()});
      masks_[stop->mask + k] = yes;
    }
  }
}

void Branches::find_hits() {
  screens_.clear();
  for (std::size_t link = 0; link < chain_.size(); ++link) {
    const Screen* screen = screen_of(chain_[link]);
    if (screen == nullptr) continue;
    ScreenBook book{link, -1, masks_.size(), {}, {}};
    for (std::size_t k = link; k < chain_.size(); ++k)
      if (const auto* stretch = std::get_if<SpinStretch>(chain_[k].stage);
          stretch && stretch->part == screen->part)
        book.stretch = static_cast<int>(k);
    for (std::size_t path = 0; path < levels_.size(); ++path) new_mask();
    const std::size_t padded = number(asked_.view().padded);
    for (std::size_t k = 0; k < number(asked_.view().count); ++k) {
      if (asked_.view().weight[k] == 0) continue;
      const std::size_t cells = book.cells.size();
      for (std::size_t path = 0; path < levels_.size(); ++path) {
        const std::size_t at = number_[k];
        const std::uint32_t bin = ends_[path].bin[at];
        if (ends_[path].link[at] != link || bin == not_counted) continue;
        masks_[book.hits + path * padded + k] = yes;
        // Paths of one cell stand one after the other: there are few in a bin.
        auto cell = std::find_if(book.cells.begin() + static_cast<std::ptrdiff_t>(cells), book.cells.end(),
                                 [&](const Cell& c) { return c.bin == bin; });
        std::size_t end = book.cell_paths.size();
        if (cell == book.cells.end())
          cell = book.cells.insert(cell, {bin, static_cast<std::uint16_t>(k), 0});
        else
          for (auto behind = book.cells.end(); --behind != cell;) end -= behind->paths;
        ++cell->paths;
        book.cell_paths.insert(book.cell_paths.begin() + static_cast<std::ptrdiff_t>(end),
                               static_cast<std::uint8_t>(path));
      }
    }
    screens_.push_back(std::move(book));
  }
}

// ---- one way to share ----

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
    const std::uint64_t* ends_here = &masks_[stop.mask];
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
  const ShareCount shares{shares_.data(), &masks_[book.hits],
                          levels_.data(), static_cast<int>(levels_.size()),
                          asked.padded,   screen.efficiency};
  kernels_->count_shares(shares, counts_.data(), totals_.data(), by_path);
  own[layout.total()] += by_path.q[levels_.size()];
  own[layout.total() + 1] +=
      joined(by_path.squares_high[levels_.size()], by_path.squares_low[levels_.size()]);
  const std::uint8_t* listed = book.cell_paths.data();
  for (const Cell& cell : book.cells) {
    std::uint64_t q = 0;
    for (int n = 0; n < cell.paths; ++n) q += counts_[*listed++ * padded + cell.particle];
    own[layout.bin(cell.bin)] += q;
    own[layout.bin(cell.bin) + 1] += static_cast<Sum>(q) * q;
  }
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
              shares_[number(levels_[n]) * padded + number(i)] & masks_[book.hits + n * padded + number(i)];
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
