#include "transport/branches.hpp"

#include <algorithm>

namespace rabiline {
namespace {

constexpr std::uint64_t yes = ~std::uint64_t{0};

}  // namespace

const Screen* screen_of(const ChainLink& link) {
  const auto* score = std::get_if<Score>(link.stage);
  return score != nullptr ? &score->screen : nullptr;
}

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

void Branches::fly(const Batch& batch, const std::vector<ChainLink>& chain,
                   const std::vector<std::uint64_t>& reach, const Kernels& kernels, const RandomKey& key) {
  chain_ = chain;
  kernels_ = &kernels;
  key_ = key;
  std::size_t most = 0;
  for (const ChainLink& link : chain) most = std::max(most, sums_needed(*link.stage));
  unused_.assign(most, 0);
  std::uint64_t levels = 0;
  for (const std::uint64_t mask : reach) levels |= mask;
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
  for (std::size_t path = 0; path < levels_.size(); ++path) fly_on(path, batch, reach);
  keep_undecided(batch);
  masks_.clear();
  find_stops();
  find_hits();
}

/// Particles that may be found in a level, one after the other, in that level.
void Branches::gather(const Batch& batch, int level, const std::vector<std::uint64_t>& reach) {
  const BatchView& from = batch.view();
  BatchView& to = flown_.view();
  to.y = from.y;
  int count = 0;
  for (int i = 0; i < from.count; ++i) {
    if (from.flying[i] == 0 || (reach[from.level[i]] >> level & 1) == 0) continue;
    flown_number_[number(count)] = static_cast<std::uint16_t>(i);
    for (const auto column : {&BatchView::x, &BatchView::z, &BatchView::vx, &BatchView::vy, &BatchView::vz,
                              &BatchView::t, &BatchView::slowness})
      (to.*column)[count] = (from.*column)[i];
    for (const auto column : {&BatchView::weight, &BatchView::particle, &BatchView::prepared})
      (to.*column)[count] = (from.*column)[i];
    to.flying[count++] = yes;
  }
  to.count = count;
  to.padded = (count + 7) / 8 * 8;
  for (int i = count; i < to.padded; ++i) to.flying[i] = 0;
  for (const auto column :
       {&BatchView::x, &BatchView::z, &BatchView::vx, &BatchView::vz, &BatchView::t, &BatchView::slowness})
    std::fill(to.*column + count, to.*column + to.padded, 0.0);
  std::fill(to.vy + count, to.vy + to.padded, 1.0);
  for (const auto column : {&BatchView::weight, &BatchView::particle, &BatchView::prepared})
    std::fill(to.*column + count, to.*column + to.padded, 0);
  std::fill_n(to.caught_by, to.padded, 0);
  std::fill_n(to.level, to.padded, static_cast<std::uint64_t>(level));
  std::fill_n(to.sx, to.padded, 0.0);
  std::fill_n(to.sy, to.padded, 0.0);
  std::fill_n(to.sz, to.padded, 1.0);
}

void Branches::fly_on(std::size_t path, const Batch& batch, const std::vector<std::uint64_t>& reach) {
  Ends& ends = ends_[path];
  ends.link.fill(not_flown);
  gather(batch, levels_[path], reach);
  const BatchView& b = flown_.view();
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
    for (std::size_t n = 0; n < number(b.count); ++n) {
      if (flying[n] == 0 || b.flying[n] != 0) continue;
      const std::size_t i = flown_number_[n];
      ends.link[i] = static_cast<std::uint16_t>(k);
      ends.level[i] = static_cast<std::uint8_t>(b.level[n]);
      ends.bin[i] = is_screen ? static_cast<std::uint32_t>(b.scratch[n]) : not_counted;
    }
  }
}

/// What a tally sees of the particles on a path where they are now.
void Branches::look(std::size_t link, std::size_t path) {
  Flight flight{*kernels_, key_, flown_, unused_.data()};
  const auto count = number(flown_.view().count);
  for (HistogramBook& book : histograms_) {
    if (book.link != link) continue;
    HistogramPlaces seen;
    find_places(std::get<Histogram>(*chain_[link].stage), flight, seen);
    HistogramPlaces& places = book.places[path];
    places.bin.fill(HistogramPlaces::nowhere);
    for (std::size_t n = 0; n < count; ++n) {
      places.bin[flown_number_[n]] = seen.bin[n];
      for (std::size_t axis = 0; axis < seen.steps.size(); ++axis)
        places.steps[axis][flown_number_[n]] = seen.steps[axis][n];
    }
  }
  for (MonitorBook& book : monitors_) {
    if (book.link != link) continue;
    alignas(64) std::uint64_t weights[capacity];
    kernels_->cross(std::get<Census>(*chain_[link].stage).face, flown_.view(), weights);
    book.crossed[path].fill(0);
    for (std::size_t n = 0; n < count; ++n) book.crossed[path][flown_number_[n]] = weights[n] != 0 ? yes : 0;
  }
}

/// Particles that end alike in every level, and are not counted by a screen, are decided. The others are put
/// together by the level that they were prepared in.
void Branches::keep_undecided(const Batch& batch) {
  const BatchView& from = batch.view();
  decided_.assign(chain_.size() * most_levels, 0);
  std::array<std::vector<int>, most_levels> undecided;
  for (int i = 0; i < from.count; ++i) {
    if (from.flying[i] == 0) continue;
    const std::size_t at = number(i);
    const Ends& first =
        *std::find_if(ends_.begin(), ends_.end(), [&](const Ends& e) { return e.link[at] != not_flown; });
    const bool alike = std::all_of(ends_.begin(), ends_.end(), [&](const Ends& e) {
      return e.link[at] == not_flown || (e.link[at] == first.link[at] && e.bin[at] == not_counted);
    });
    if (alike && monitors_.empty())
      decided_[std::size_t{first.link[at]} * most_levels + from.prepared[i]] += from.weight[i];
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
  const std::size_t begin = masks_.size();
  masks_.resize(begin + number(asked_.view().padded) / 8, Line{});
  return 8 * begin;
}

void Branches::find_stops() {
  stops_.clear();
  for (std::size_t path = 0; path < levels_.size(); ++path) {
    const std::size_t known = stops_.size();
    for (std::size_t k = 0; k < number(asked_.view().count); ++k) {
      const std::size_t at = number_[k], link = ends_[path].link[at];
      if (link == not_flown || ends_[path].bin[at] != not_counted) continue;
      auto stop = std::find_if(stops_.begin() + static_cast<std::ptrdiff_t>(known), stops_.end(),
                               [&](const Stop& s) { return s.link == link; });
      if (stop == stops_.end()) stop = stops_.insert(stops_.end(), {path, link, new_mask()});
      masks()[stop->mask + k] = yes;
    }
  }
}

std::vector<Branches::Neighbours> Branches::neighbours_of(const std::vector<Cell>& cells,
                                                          const ScreenSums& layout) {
  std::vector<Neighbours> found;
  for (std::uint32_t second = 1; second < cells.size(); ++second)
    for (std::uint32_t first = second; first-- > 0 && cells[first].particle == cells[second].particle;) {
      const std::size_t a = cells[first].bin, b = cells[second].bin;
      if (a / layout.rows == b / layout.rows)
        found.push_back({first, second, layout.across_column(a / layout.rows)});
      else if (a % layout.rows == b % layout.rows)
        found.push_back({first, second, layout.across_row(a % layout.rows)});
    }
  return found;
}

void Branches::find_hits() {
  screens_.clear();
  for (std::size_t link = 0; link < chain_.size(); ++link) {
    const Screen* screen = screen_of(chain_[link]);
    if (screen == nullptr) continue;
    ScreenBook book{link, -1, 8 * masks_.size(), {}, {}, {}};
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
        masks()[book.hits + path * padded + k] = yes;
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
    book.neighbours = neighbours_of(book.cells, sums_of(*screen));
    screens_.push_back(std::move(book));
  }
}

}  // namespace rabiline
