#include "simulation/tallies.hpp"

#include <cmath>

namespace rabiline {

Tallies::Tallies(const Plan& plan) {
  for (const PlanTree& tree : plan.trees) {
    tree_ = &tree;
    for (const PlanNode& node : tree.next) visit(node);
  }
}

void Tallies::visit(const PlanNode& node) {
  std::visit([&](const auto& stage) { add(stage, Stand{node.sums, &node.points}); }, node.stage);
  for (const PlanNode::Way& way : node.ways) visit_way(node.next.front(), way);
  if (!node.ways.empty()) return;
  for (const PlanNode& next : node.next) visit(next);
}

/// What stands behind a projection, for one way to share the weights there.
void Tallies::visit_way(const PlanNode& node, const PlanNode::Way& way) {
  std::visit([&](const auto& stage) { add(stage, Stand{node.sums + way.shift, &way.points}); }, node.stage);
  for (const PlanNode& next : node.next) visit_way(next, way);
}

void Tallies::add(const Passage& passage, const Stand& sums) {
  fates.push_back({Fate::stopped, passage.part, sums.at, sums.points});
}

void Tallies::add(const Filter& filter, const Stand& sums) {
  fates.push_back({Fate::stopped, filter.part, sums.at, sums.points});
}

void Tallies::add(const Deflection& deflection, const Stand& sums) {
  fates.push_back({Fate::stopped, deflection.part, sums.at, sums.points});
}

void Tallies::add(const Exit&, const Stand& sums) {
  fates.push_back({Fate::passed, no_part, sums.at, sums.points});
}

void Tallies::add(const SpinStretch& stretch, const Stand& sums) {
  levels.push_back({stretch.part, tree_->component, stretch.levels, sums.at, sums.points});
}

void Tallies::add(const Census& census, const Stand& sums) {
  censuses.push_back({census.part, tree_, sums.at, sums.points});
}

void Tallies::add(const Histogram& histogram, const Stand& sums) {
  histograms.push_back({&histogram, tree_, sums.at, sums.points});
}

void Tallies::add(const Score& score, const Stand& sums) { add_screen(score.screen, sums); }

void Tallies::add_screen(const Screen& screen, const Stand& sums) {
  const ScreenSums layout = sums_of(screen);
  screens.push_back({screen.part, tree_, layout, sums.at, sums.points});
  fates.push_back({Fate::detected, screen.part, sums.at + layout.total(), sums.points});
  if (screen.efficiency != 1 || screen.has_dead_area)
    fates.push_back({Fate::stopped, screen.part, sums.at + layout.lost(), sums.points});
}

void Tallies::add(const TurningRegion& region, const Stand& sums) {
  const RegionSums layout{region.zones.size()};
  fates.push_back({Fate::left_backwards, no_part, sums.at + RegionSums::backwards(), sums.points});
  fates.push_back({Fate::gave_up, no_part, sums.at + RegionSums::gave_up(), sums.points});
  for (std::size_t i = 0; i < region.zones.size(); ++i)
    if (std::isfinite(region.zones[i].wall_radius))
      fates.push_back({Fate::stopped, region.zones[i].wall_part, sums.at + layout.wall(i), sums.points});
  std::size_t screen = sums.at + layout.screens();
  for (std::size_t i = 0; i < region.edges.size(); ++i) {
    const RegionEdge& edge = region.edges[i];
    const bool loses =
        edge.kind == EdgeKind::screen && (edge.screen.efficiency != 1 || edge.screen.has_dead_area);
    if (edge.kind == EdgeKind::plate || loses)
      fates.push_back({Fate::stopped, edge.part, sums.at + layout.edge(i), sums.points});
    if (edge.kind == EdgeKind::screen) {
      add_screen(edge.screen, {screen, sums.points});
      screen += sums_of(edge.screen).size();
    }
  }
}

}  // namespace rabiline
