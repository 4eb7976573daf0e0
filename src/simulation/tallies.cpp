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
  std::visit([&](const auto& stage) { add(stage, node); }, node.stage);
  for (const PlanNode& next : node.next) visit(next);
}

void Tallies::add(const Passage& passage, const PlanNode& node) {
  fates.push_back({Fate::stopped, passage.part, node.sums, &node.points});
}

void Tallies::add(const Filter& filter, const PlanNode& node) {
  fates.push_back({Fate::stopped, filter.part, node.sums, &node.points});
}

void Tallies::add(const Deflection& deflection, const PlanNode& node) {
  fates.push_back({Fate::stopped, deflection.part, node.sums, &node.points});
}

void Tallies::add(const Steering& steering, const PlanNode& node) {
  fates.push_back({Fate::stopped, steering.part, node.sums, &node.points});
}

void Tallies::add(const Exit&, const PlanNode& node) {
  fates.push_back({Fate::passed, no_part, node.sums, &node.points});
}

void Tallies::add(const SpinStretch& stretch, const PlanNode& node) {
  levels.push_back({stretch.part, tree_->component, stretch.levels, node.sums, &node.points});
}

void Tallies::add(const Census& census, const PlanNode& node) {
  censuses.push_back({census.part, tree_, node.sums, &node.points});
}

void Tallies::add(const Histogram& histogram, const PlanNode& node) {
  histograms.push_back({&histogram, tree_, node.sums, &node.points});
}

void Tallies::add(const Score& score, const PlanNode& node) { add_screen(score.screen, node.sums, node); }

void Tallies::add_screen(const Screen& screen, std::size_t at, const PlanNode& node) {
  const ScreenSums layout = sums_of(screen);
  screens.push_back({screen.part, tree_, layout, at, &node.points});
  fates.push_back({Fate::detected, screen.part, at + layout.total(), &node.points});
  if (screen.efficiency != 1 || screen.has_dead_area)
    fates.push_back({Fate::stopped, screen.part, at + layout.lost(), &node.points});
}

void Tallies::add(const TurningRegion& region, const PlanNode& node) {
  const RegionSums layout{region.zones.size()};
  fates.push_back({Fate::left_backwards, no_part, node.sums + RegionSums::backwards(), &node.points});
  fates.push_back({Fate::gave_up, no_part, node.sums + RegionSums::gave_up(), &node.points});
  for (std::size_t i = 0; i < region.zones.size(); ++i)
    if (std::isfinite(region.zones[i].wall_radius))
      fates.push_back({Fate::stopped, region.zones[i].wall_part, node.sums + layout.wall(i), &node.points});
  std::size_t screen = node.sums + layout.screens();
  for (std::size_t i = 0; i < region.edges.size(); ++i) {
    const RegionEdge& edge = region.edges[i];
    const bool loses =
        edge.kind == EdgeKind::screen && (edge.screen.efficiency != 1 || edge.screen.has_dead_area);
    if (edge.kind == EdgeKind::plate || loses)
      fates.push_back({Fate::stopped, edge.part, node.sums + layout.edge(i), &node.points});
    if (edge.kind == EdgeKind::screen) {
      add_screen(edge.screen, screen, node);
      screen += sums_of(edge.screen).size();
    }
  }
}

}  // namespace rabiline
