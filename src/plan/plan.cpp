#include "plan/plan.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "plan/magnets.hpp"

namespace rabiline {
namespace {

// Rough times on one core with AVX-512 [s].
constexpr double cost_of_plane = 3e-9, cost_of_emission = 1e-8, cost_of_step = 4e-9, cost_of_zone = 5e-9,
                 cost_of_closed_form = 2e-9, cost_of_tally = 1e-8;

// Estimated time for one particle of that speed on one core [s]; only its order of magnitude matters.
double cost_of(const TurningRegion& region, double speed) {
  double steps = 0;
  for (const RegionZone& zone : region.zones)
    steps += (zone.field.end - zone.field.begin) / speed / zone.step;
  return steps * cost_of_step;
}
double cost_of(const std::vector<SpinZone>& zones, double speed) {
  double sum = 0;
  for (const SpinZone& zone : zones)
    sum += zone.step > 0 ? (zone.end - zone.begin) / speed / zone.step * 4 * cost_of_step : cost_of_zone;
  return sum;
}
double cost_of(const Steering& steering, double speed) {
  return outlook_of(steering, speed).steps * 4 * cost_of_step;
}
double cost_of(const Precession& precession, double speed) { return cost_of(precession.zones, speed); }
double cost_of(const SpinStretch& stretch, double speed) {
  if (stretch.from_level && stretch.zones.size() <= 1 && stretch.levels == 2) return cost_of_closed_form;
  return cost_of_closed_form * stretch.levels + cost_of(stretch.zones, speed);
}
double cost_of(const Histogram& histogram, double speed) {
  double sum = cost_of_tally * static_cast<double>(histogram.axes.size() + 1);
  if (!histogram.zones.empty() || !histogram.polynomials.empty())
    sum += cost_of(SpinStretch{0, std::max(2, histogram.levels), true, false, histogram.zones, {}}, speed);
  return sum;
}
template <class Plain>
double cost_of(const Plain&, double) {
  return cost_of_plane;
}

struct Chain {
  int point;
  std::vector<Stage> stages;
};

/// Groups chains by their stage at `depth` and goes on behind it. Few different stages are looked through at
/// once: scans put equal ones next to each other or repeat a short list.
std::vector<PlanNode> merge(const std::vector<const Chain*>& chains, std::size_t depth, std::size_t& sums) {
  constexpr std::size_t looked_through = 16;
  std::vector<std::vector<const Chain*>> groups;
  for (const Chain* chain : chains) {
    if (chain->stages.size() == depth) continue;
    const std::size_t first = groups.size() > looked_through ? groups.size() - looked_through : 0;
    const auto group =
        std::find_if(groups.begin() + static_cast<std::ptrdiff_t>(first), groups.end(),
                     [&](const auto& g) { return g.front()->stages[depth] == chain->stages[depth]; });
    if (group == groups.end())
      groups.push_back({chain});
    else
      group->push_back(chain);
  }
  // Points that differ in what is looked at, and not in what happens, go on together.
  const bool look_apart = groups.size() > 1 && std::all_of(chains.begin(), chains.end(), [&](const Chain* c) {
                            return c->stages.size() > depth && only_reads(c->stages[depth]);
                          });
  std::vector<PlanNode> nodes;
  for (const auto& group : groups) {
    PlanNode node{group.front()->stages[depth], {}, sums, {}};
    for (const Chain* chain : group) node.points.push_back(chain->point);
    sums += sums_needed(node.stage);
    if (!look_apart) node.next = merge(group, depth + 1, sums);
    nodes.push_back(std::move(node));
  }
  if (look_apart)
    for (PlanNode& node : merge(chains, depth + 1, sums)) nodes.push_back(std::move(node));
  return nodes;
}

double cost_of_branch(const PlanNode& node, double speed) {
  double sum = std::visit([&](const auto& stage) { return cost_of(stage, speed); }, node.stage);
  for (const PlanNode& next : node.next) sum += cost_of_branch(next, speed);
  return sum;
}

/// First particle of each species: fractions of the whole, rounded so that all particles are shared out.
std::vector<std::uint64_t> shares(const Beamline& beamline) {
  std::vector<std::uint64_t> first{0};
  double sum = 0;
  for (const Component& component : beamline.species) {
    sum += component.fraction;
    first.push_back(static_cast<std::uint64_t>(std::llround(sum * static_cast<double>(beamline.particles))));
  }
  first.back() = beamline.particles;
  return first;
}

/// Everything that two points must share to stand in one tree.
struct Root {
  int component;
  std::uint64_t first, last;
  Emission source;
  bool operator==(const Root&) const = default;
};

struct Group {
  Root root;
  std::vector<Chain> chains;
};

std::vector<Group> group_by_source(const Experiment& experiment, SampledTables& tables) {
  const ScreenGrids grids = screen_grids(experiment.points);
  std::vector<Group> groups;
  for (std::size_t p = 0; p < experiment.points.size(); ++p) {
    const Beamline& beamline = experiment.points[p];
    const auto first = shares(beamline);
    const std::uint32_t stream =
        experiment.particles == ScanParticles::shared ? 0 : static_cast<std::uint32_t>(p) + 1;
    for (std::size_t k = 0; k < beamline.species.size(); ++k) {
      if (first[k] == first[k + 1]) continue;
      const Component& component = beamline.species[k];
      const Root root{static_cast<int>(k), first[k], first[k + 1],
                      emission_of(beamline, component, {beamline.seed, stream}, tables)};
      auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.root == root; });
      if (stream != 0 || group == groups.end()) group = groups.insert(groups.end(), {root, {}});
      group->chains.push_back({static_cast<int>(p), compile(beamline, component, grids, tables)});
    }
  }
  return groups;
}

PlanTree make_tree(const Root& root, const std::vector<const Chain*>& chains, std::size_t& sums) {
  PlanTree tree;
  tree.component = root.component;
  tree.first = root.first;
  tree.last = root.last;
  tree.source = root.source;
  for (const Chain* chain : chains) tree.points.push_back(chain->point);
  tree.sums = sums;
  sums += sums_of(root.source).size();
  tree.next = merge(chains, 0, sums);
  tree.cost = cost_of_emission;
  for (const PlanNode& node : tree.next) tree.cost += cost_of_branch(node, root.source.speed);
  return tree;
}

}  // namespace

Plan make_plan(const Experiment& experiment, double most_cost) {
  Plan plan;
  plan.points = static_cast<int>(experiment.points.size());
  const auto tables = std::make_shared<SampledTables>();
  plan.tables = tables;
  for (const Group& group : group_by_source(experiment, *tables)) {
    std::vector<const Chain*> chains;
    for (const Chain& chain : group.chains) chains.push_back(&chain);
    std::size_t unused = 0;
    const double cost = 64 * make_tree(group.root, chains, unused).cost;
    const auto parts =
        std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(cost / most_cost)), 1, chains.size());
    for (std::size_t i = 0; i < parts; ++i) {
      const auto begin = chains.begin() + static_cast<std::ptrdiff_t>(chains.size() * i / parts);
      const auto end = chains.begin() + static_cast<std::ptrdiff_t>(chains.size() * (i + 1) / parts);
      plan.trees.push_back(make_tree(group.root, {begin, end}, plan.sums));
    }
  }
  return plan;
}

}  // namespace rabiline
