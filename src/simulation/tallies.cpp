#include "simulation/tallies.hpp"

namespace rabiline {

Tallies::Tallies(const Plan& plan) {
  for (const PlanTree& tree : plan.trees) {
    tree_ = &tree;
    for (const PlanNode& node : tree.next) visit(node);
  }
}

void Tallies::visit(const PlanNode& node) {
  if (!node.reweightings.empty() && node.next.empty()) {
    for (const PlanNode::Reweighting& reweighting : node.reweightings)
      list(node.stage, node.sums + reweighting.shift, 0, reweighting.points);
    return;
  }
  list(node.stage, node.sums, node.ledger, node.points);
  by_moments_ = node.transit != nullptr;
  for (const PlanNode::Reweighting& reweighting : node.reweightings)
    visit_reweighted(node.next.front(), reweighting);
  by_moments_ = false;
  if (!node.reweightings.empty()) return;
  for (const PlanNode& next : node.next) visit(next);
}

/// What stands behind a projection, for one reweighting there.
void Tallies::visit_reweighted(const PlanNode& node, const PlanNode::Reweighting& reweighting) {
  list(node.stage, node.sums + reweighting.shift, node.ledger == 0 ? 0 : node.ledger + reweighting.shift,
       reweighting.points);
  for (const PlanNode& next : node.next) visit_reweighted(next, reweighting);
}

void Tallies::list(const Stage& stage, std::size_t sums, std::size_t ledger, const std::vector<int>& points) {
  sums_ = sums;
  ledger_ = ledger;
  points_ = &points;
  list_sums(stage, *this);
}

void Tallies::fate(std::string_view word, int part, std::size_t at) {
  fates.push_back({place(at), word, part, tree_->component, ledger_, tree_->ledger_levels});
}
void Tallies::screen(int part, const ScreenSums& layout, std::size_t at) {
  screens.push_back({place(at), part, layout});
}
void Tallies::levels(int part, int levels, std::size_t at) {
  level_tallies.push_back({place(at), part, tree_->component, levels});
}
void Tallies::plane(int part, int plane, std::size_t at) { censuses.push_back({place(at), part, plane}); }
void Tallies::histogram(int part, int tally, int plane, const HistogramSums& layout, std::size_t at) {
  histograms.push_back({place(at), part, tally, plane, layout});
}

}  // namespace rabiline
