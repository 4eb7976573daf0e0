#include "simulation/transit_times.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "simulation/counting.hpp"

namespace rabiline {
namespace {

/// w and w^2 of a path in each cell, in units of a particle.
struct Path {
  std::string name;
  std::vector<double> w, w2;
};

class PathReader {
 public:
  PathReader(const TransitLayout& layout, const Sum* sums) : layout_(layout), sums_(sums) {}

  /// What a screen catches of a path, on all its bins.
  Path read(std::size_t link, std::size_t from, std::size_t rank, std::string name) const {
    Path path{std::move(name), {}, {}};
    for (std::size_t cell = 0; cell < static_cast<std::size_t>(layout_.cells().count); ++cell) {
      Sum w = 0, w2 = 0;
      for (std::size_t bin = 0; bin < layout_.link(link).bins; ++bin) {
        w += sums_[layout_.moment(layout_.share(link, bin, from, rank), cell, 0)];
        w2 += sums_[layout_.moment(layout_.square(link, bin, from, rank, rank), cell, 0)];
      }
      path.w.push_back(particles(w));
      path.w2.push_back(particles(w2));  // kept in units of 2^-40 particle^2
    }
    return path;
  }

 private:
  const TransitLayout& layout_;
  const Sum* sums_;
};

/// Of cells and paths, those that hold anything.
TransitResult trimmed(const SlownessCells& cells, std::vector<Path> paths) {
  std::erase_if(paths,
                [](const Path& p) { return std::ranges::all_of(p.w, [](double w) { return w == 0; }); });
  auto first = static_cast<std::size_t>(cells.count), last = std::size_t{0};
  for (const Path& path : paths)
    for (std::size_t cell = 0; cell < path.w.size(); ++cell)
      if (path.w[cell] != 0) {
        first = std::min(first, cell);
        last = std::max(last, cell + 1);
      }
  TransitResult out;
  if (paths.empty()) return out;
  for (std::size_t cell = first; cell <= last; ++cell)
    out.edges.push_back(cells.first + cells.width * static_cast<double>(cell));
  for (const Path& path : paths) {
    out.paths.push_back(path.name);
    for (std::size_t cell = first; cell < last; ++cell) {
      out.caught.push_back(path.w[cell]);
      out.errors.push_back(std::sqrt(path.w2[cell]));
    }
  }
  return out;
}

std::vector<Path> paths_behind(const PlanNode& projection, int part, const std::vector<std::string>& names,
                               const Sums& sums) {
  const TransitLayout& layout = *projection.transit;
  const PathReader reader(layout, &sums[projection.moments]);
  std::vector<Path> paths;
  std::size_t link = 0;
  for (const PlanNode* node = &projection; !node->next.empty(); ++link) {
    node = &node->next.front();
    if (catches(node->stage) != part) continue;
    for (std::size_t from = 0; from < layout.levels(); ++from)
      for (std::size_t rank = 0; rank < layout.paths(link, from); ++rank)
        paths.push_back(
            reader.read(link, from, rank,
                        fmt::format("{} to {}", names[from],
                                    names[static_cast<std::size_t>(layout.outcomes(from)[rank])])));
  }
  return paths;
}

std::vector<Path> paths_caught(const PlanNode& levels, const std::vector<std::string>& names,
                               const Sums& sums) {
  const PathReader reader(*levels.transit, &sums[levels.moments]);
  std::vector<Path> paths;
  for (std::size_t from = 0; from < levels.transit->levels(); ++from)
    paths.push_back(reader.read(0, from, 0, names[from]));
  return paths;
}

}  // namespace

std::vector<TransitResult> transits_to(int part, const Beamline& beamline, const Plan& plan,
                                       const Sums& sums) {
  std::vector<TransitResult> out;
  int known = -1;  // species
  for (const PlanTree& tree : plan.trees)
    each_transit(tree.next, [&](const PlanNode& node) {
      if (tree.component == known) return;
      const Species& species = beamline.species[static_cast<std::size_t>(tree.component)].species;
      const std::vector<std::string> names =
          names_of_levels(species, static_cast<int>(node.transit->levels()));
      std::vector<Path> paths;
      if (!node.next.empty())
        paths = paths_behind(node, part, names, sums);
      else if (reads_catch_of(node.stage) == part)
        paths = paths_caught(node, names, sums);
      TransitResult found = trimmed(node.transit->cells(), std::move(paths));
      if (found.paths.empty()) return;
      if (beamline.species.size() > 1) found.species = species.name;
      out.push_back(std::move(found));
      known = tree.component;
    });
  return out;
}

}  // namespace rabiline
