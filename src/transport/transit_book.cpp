#include "transport/transit_book.hpp"

#include <stdexcept>

namespace rabiline {

void TransitBook::add(const TransitLayout& layout, const Paths& paths, const BatchView& batch,
                      const std::vector<int>& particles, Isa isa, MomentBuffer& buffer) {
  path_of_.assign(most_levels, 0);
  for (std::size_t path = 0; path < paths.levels.size(); ++path)
    path_of_[static_cast<std::size_t>(paths.levels[path])] = path;
  entries_.clear();
  for (const int i : particles) {
    const std::size_t from = batch.level[i];
    find_ends(layout, paths, from, static_cast<std::size_t>(i));
    enter(layout, from, batch.weight[i], 1 / batch.vy[i]);
  }
  add_entries(layout, isa, buffer);
}

void TransitBook::add_entries(const TransitLayout& layout, Isa isa, MomentBuffer& buffer) {
  buffer.cells.resize(layout.size());
  for (const TransitEntry& entry : entries_)
    if (buffer.cells[entry.cell].of[0] == 0) buffer.touched.push_back(entry.cell);
  kernel::add_moments(isa)(entries_.data(), entries_.size(), buffer.cells.data());
}

bool TransitBook::add_catch(const TransitLayout& layout, const BatchView& batch, int part, Isa isa,
                            MomentBuffer& buffer) {
  entries_.clear();
  ends_.assign(1, {0, 0});
  bool all = true;
  for (int i = 0; i < batch.count; ++i) {
    if (batch.caught_by[i] != static_cast<std::uint64_t>(part) + 1) continue;
    if (layout.cells().contains(batch.slowness[i]))
      enter(layout, batch.level[i], batch.weight[i], batch.slowness[i]);
    else
      all = false;
  }
  add_entries(layout, isa, buffer);
  return all;
}

void TransitBook::find_ends(const TransitLayout& layout, const Paths& paths, std::size_t from,
                            std::size_t number) {
  ends_.clear();
  for (const int level : layout.outcomes(from)) {
    const PathEnds& ends = paths.ends[path_of_[static_cast<std::size_t>(level)]];
    ends_.push_back({ends.link[number], ends.bin[number]});
  }
}

void TransitBook::enter(const TransitLayout& layout, std::size_t from, std::uint64_t weight,
                        double slowness) {
  const SlownessCells& cells = layout.cells();
  const double at = (slowness - cells.first) / cells.width;
  const auto cell = static_cast<std::size_t>(at);
  const double t = 2 * (at - static_cast<double>(cell)) - 1;
  if (layout.weights_alike() && weight != quanta_per_particle)
    throw std::logic_error("weights that should be alike are not");
  const double w = static_cast<double>(weight), w2 = w * w * 0x1p-40;
  const auto put = [&](std::size_t row, double what) {
    entries_.push_back({row * static_cast<std::size_t>(cells.count) + cell, t, what});
  };
  for (std::size_t a = 0; a < ends_.size(); ++a) {
    const End& end = ends_[a];
    if (end.bin == PathEnds::not_caught) {
      put(layout.stop(end.link, from, a), w);
      continue;
    }
    put(layout.share(end.link, end.bin, from, a), w);
    if (!layout.weights_alike()) put(layout.square(end.link, end.bin, from, a, a), w2);
    for (std::size_t b = 0; b < a; ++b) {
      if (ends_[b].link != end.link || ends_[b].bin == PathEnds::not_caught) continue;
      if (ends_[b].bin == end.bin) {
        put(layout.square(end.link, end.bin, from, a, b), w2);
        continue;
      }
      put(layout.screen(end.link, from, a, b), w2);
      const std::size_t rows = layout.link(end.link).screen.rows;
      if (ends_[b].bin / rows == end.bin / rows)
        put(layout.column(end.link, end.bin / rows, from, a, b), w2);
      else if (ends_[b].bin % rows == end.bin % rows)
        put(layout.row(end.link, end.bin % rows, from, a, b), w2);
    }
  }
}

}  // namespace rabiline
