#include "transport/transit_book.hpp"

#include <stdexcept>

namespace rabiline {

void TransitBook::add(const TransitLayout& layout, const Paths& paths,
                      const std::vector<std::unique_ptr<PathTally>>& tallies, const BatchView& batch,
                      const std::vector<int>& particles, Isa isa, MomentBuffer& buffer) {
  path_of_.assign(most_levels, 0);
  for (std::size_t path = 0; path < paths.levels.size(); ++path)
    path_of_[static_cast<std::size_t>(paths.levels[path])] = path;
  entries_.clear();
  for (const int i : particles) {
    const Particle p = particle_of(layout, batch, i);
    enter_stops(layout, paths, p);
    for (std::size_t link = 0; link < layout.links(); ++link) {
      const TransitLink& kind = layout.link(link);
      if (kind.bins == 0) continue;
      bins_.clear();
      for (std::size_t a = 0; a < layout.paths(link, p.from); ++a) {
        const std::size_t path = path_of_[static_cast<std::size_t>(layout.outcomes(p.from)[a])];
        const PathEnds& ends = paths.ends[path];
        bins_.push_back(!kind.ends                    ? tallies[link]->places(path)->bin[p.number]
                        : ends.link[p.number] == link ? ends.bin[p.number]
                                                      : PathPlaces::nowhere);
      }
      enter_bins(layout, link, p);
      if (kind.axes > 0) enter_places(layout, link, *tallies[link], p);
    }
  }
  add_entries(layout, isa, buffer);
}

bool TransitBook::add_catch(const TransitLayout& layout, const BatchView& batch, int part, Isa isa,
                            MomentBuffer& buffer) {
  entries_.clear();
  bins_.assign(1, 0);
  bool all = true;
  for (int i = 0; i < batch.count; ++i) {
    if (batch.caught_by[i] != static_cast<std::uint64_t>(part) + 1) continue;
    if (layout.cells().contains(batch.slowness[i]))
      enter_bins(layout, 0, particle_of(layout, batch, i));
    else
      all = false;
  }
  add_entries(layout, isa, buffer);
  return all;
}

void TransitBook::add_entries(const TransitLayout& layout, Isa isa, MomentBuffer& buffer) {
  buffer.cells.resize(layout.size());
  for (const TransitEntry& entry : entries_)
    if (buffer.cells[entry.cell].of[0] == 0) buffer.touched.push_back(entry.cell);
  kernel::add_moments(isa)(entries_.data(), entries_.size(), buffer.cells.data());
}

TransitBook::Particle TransitBook::particle_of(const TransitLayout& layout, const BatchView& batch, int i) {
  const SlownessCells& cells = layout.cells();
  const double at = (batch.slowness[i] - cells.first) / cells.width;
  const auto cell = static_cast<std::uint64_t>(at);
  if (layout.weights_alike() && batch.weight[i] != quanta_per_particle)
    throw std::logic_error("weights that should be alike are not");
  const double w = static_cast<double>(batch.weight[i]);
  return {batch.level[i],
          static_cast<std::size_t>(i),
          batch.particle[i] % moment_groups,
          cell,
          2 * (at - static_cast<double>(cell)) - 1,
          w,
          w * w * 0x1p-40};
}

void TransitBook::put(const TransitLayout& layout, const Particle& p, std::size_t row, double what) {
  entries_.push_back({row * static_cast<std::size_t>(layout.cells().count) + p.cell, p.t, what});
}

void TransitBook::enter_stops(const TransitLayout& layout, const Paths& paths, const Particle& p) {
  const std::vector<int>& outcomes = layout.outcomes(p.from);
  for (std::size_t a = 0; a < outcomes.size(); ++a) {
    const PathEnds& ends = paths.ends[path_of_[static_cast<std::size_t>(outcomes[a])]];
    if (ends.bin[p.number] == PathEnds::not_caught)
      put(layout, p, layout.stop(ends.link[p.number], p.from, a), p.w);
  }
}

void TransitBook::enter_bins(const TransitLayout& layout, std::size_t link, const Particle& p) {
  for (std::size_t a = 0; a < bins_.size(); ++a) {
    if (bins_[a] == PathPlaces::nowhere) continue;
    put(layout, p, layout.share(link, bins_[a], p.from, a), p.w);
    if (!layout.weights_alike()) put(layout, p, layout.square(link, bins_[a], p.from, a, a), p.w2);
    for (std::size_t b = 0; b < a; ++b)
      if (bins_[b] != PathPlaces::nowhere) enter_pair(layout, link, p, a, b);
  }
}

void TransitBook::enter_pair(const TransitLayout& layout, std::size_t link, const Particle& p, std::size_t a,
                             std::size_t b) {
  if (bins_[a] == bins_[b]) return put(layout, p, layout.square(link, bins_[a], p.from, a, b), p.w2);
  if (!layout.link(link).is_screen()) return;
  put(layout, p, layout.screen(link, p.from, a, b), p.w2);
  const std::size_t rows = layout.link(link).rows;
  if (bins_[a] / rows == bins_[b] / rows)
    put(layout, p, layout.column(link, bins_[a] / rows, p.from, a, b), p.w2);
  else if (bins_[a] % rows == bins_[b] % rows)
    put(layout, p, layout.row(link, bins_[a] % rows, p.from, a, b), p.w2);
}

void TransitBook::enter_places(const TransitLayout& layout, std::size_t link, const PathTally& tally,
                               const Particle& p) {
  const TransitLink& kind = layout.link(link);
  for (std::size_t a = 0; a < bins_.size(); ++a) {
    if (bins_[a] == PathPlaces::nowhere || bins_[a] + 1 == kind.bins) continue;
    const PathPlaces& seen = *tally.places(path_of_[static_cast<std::size_t>(layout.outcomes(p.from)[a])]);
    put(layout, p, layout.inside(link, p.group, p.from, a), p.w);
    for (std::size_t axis = 0; axis < kind.axes; ++axis) {
      const double u = seen.steps[axis][p.number] / moment_steps;
      put(layout, p, layout.place(link, axis, p.group, 1, p.from, a), p.w * u);
      put(layout, p, layout.place(link, axis, p.group, 2, p.from, a), p.w * u * u);
    }
  }
}

}  // namespace rabiline
