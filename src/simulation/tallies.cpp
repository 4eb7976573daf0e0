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
  std::visit([&](const auto& stage) { add(stage, Stand{node.sums, &node.points, node.ledger}); }, node.stage);
  for (const PlanNode::Way& way : node.ways) visit_way(node.next.front(), way);
  if (!node.ways.empty()) return;
  for (const PlanNode& next : node.next) visit(next);
}

/// What stands behind a projection, for one way to share the weights there.
void Tallies::visit_way(const PlanNode& node, const PlanNode::Way& way) {
  std::visit(
      [&](const auto& stage) {
        add(stage, Stand{node.sums + way.shift, &way.points, node.ledger == 0 ? 0 : node.ledger + way.shift});
      },
      node.stage);
  for (const PlanNode& next : node.next) visit_way(next, way);
}

void Tallies::add_fate(Fate fate, int part, std::size_t at, const Stand& sums) {
  fates.push_back({fate, part, at, sums.points, tree_->component, sums.ledger, tree_->ledger_levels});
}

void Tallies::add(const Passage& passage, const Stand& sums) {
  add_fate(Fate::stopped, passage.part, sums.at, sums);
}

void Tallies::add(const Filter& filter, const Stand& sums) {
  add_fate(Fate::stopped, filter.part, sums.at, sums);
}

void Tallies::add(const Steering& steering, const Stand& sums) {
  add_fate(Fate::stopped, steering.part, sums.at, sums);
}

void Tallies::add(const Deflection& deflection, const Stand& sums) {
  add_fate(Fate::stopped, deflection.part, sums.at, sums);
}

void Tallies::add(const Exit&, const Stand& sums) { add_fate(Fate::passed, no_part, sums.at, sums); }

void Tallies::add(const SpinStretch& stretch, const Stand& sums) {
  levels.push_back({stretch.part, tree_->component, stretch.levels, sums.at, sums.points});
}

void Tallies::add(const Census& census, const Stand& sums) {
  censuses.push_back({census.part, census.plane, tree_, sums.at, sums.points});
}

void Tallies::add(const Histogram& histogram, const Stand& sums) {
  histograms.push_back({&histogram, tree_, sums.at, sums.points});
}

void Tallies::add(const Score& score, const Stand& sums) { add_screen(score.screen, sums); }

void Tallies::add_screen(const Screen& screen, const Stand& sums) {
  const ScreenSums layout = sums_of(screen);
  screens.push_back({screen.part, tree_, layout, sums.at, sums.points});
  add_fate(Fate::detected, screen.part, sums.at + layout.total(), sums);
  if (screen.efficiency != 1 || screen.has_dead_area)
    add_fate(Fate::stopped, screen.part, sums.at + layout.lost(), sums);
}

void Tallies::add(const TurningRegion& region, const Stand& sums) {
  const RegionSums layout{region.zones.size()};
  add_fate(Fate::left_backwards, no_part, sums.at + RegionSums::backwards(), sums);
  add_fate(Fate::gave_up, no_part, sums.at + RegionSums::gave_up(), sums);
  for (std::size_t i = 0; i < region.zones.size(); ++i)
    if (std::isfinite(region.zones[i].wall_radius))
      add_fate(Fate::stopped, region.zones[i].wall_part, sums.at + layout.wall(i), sums);
  std::size_t screen = sums.at + layout.screens();
  for (std::size_t i = 0; i < region.edges.size(); ++i) {
    const RegionEdge& edge = region.edges[i];
    const bool loses =
        edge.kind == EdgeKind::screen && (edge.screen.efficiency != 1 || edge.screen.has_dead_area);
    if (edge.kind == EdgeKind::plate || loses)
      add_fate(Fate::stopped, edge.part, sums.at + layout.edge(i), sums);
    if (edge.kind == EdgeKind::screen) {
      add_screen(edge.screen, {screen, sums.points});
      screen += sums_of(edge.screen).size();
    }
  }
  std::size_t sight = sums.at + sums_before_sights(region);
  const auto add_next = [&](const auto& stage) {
    add(stage, {sight, sums.points});
    sight += sums_needed(stage);
  };
  for (const Sight& seen : region.sights) {
    add_next(seen.census);
    for (const Histogram& tally : seen.tallies) add_next(tally);
  }
}

}  // namespace rabiline
