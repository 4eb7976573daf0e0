#include "plan/plan.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "plan/frequency_nodes.hpp"
#include "plan/gathered_filters.hpp"
#include "plan/neighbours.hpp"
#include "plan/transits.hpp"
#include "transport/cost.hpp"

namespace rabiline {
namespace {

struct Chain {
  int point;
  std::vector<Stage> stages;
  bool of_atom;  // the species has levels
};

bool splits_at(const Chain& chain, std::size_t depth) {
  return depth < chain.stages.size() && splits(chain.stages[depth]);
}

/// Merges chains into a tree and gives each stage its place among the sums.
class TreeMaker {
 public:
  /// Sums begin at `sums`; `ledger_levels`: 0 for no ledger by level.
  TreeMaker(std::size_t sums, std::size_t ledger_levels, Neighbours& neighbours)
      : sums_(sums), ledger_levels_(ledger_levels), neighbours_(neighbours) {}

  std::size_t end_of_sums() const { return sums_; }

  /// Points that share their weights over the levels in different ways, and then go on alike, are one node.
  std::vector<PlanNode> merge_reweightings(const std::vector<const Chain*>& chains, std::size_t depth) {
    const auto behind = static_cast<std::ptrdiff_t>(depth) + 1;
    const auto go_on_alike = [&](const Chain& a, const Chain& b) {
      return std::equal(a.stages.begin() + behind, a.stages.end(), b.stages.begin() + behind, b.stages.end());
    };
    std::vector<PlanNode> nodes;
    for (const std::vector<const Chain*>& group : grouped(chains, go_on_alike)) {
      PlanNode node{group.front()->stages[depth], {}, sums_, {}};
      const std::size_t begin = sums_;
      node.next = merge({group.front()}, depth + 1);
      const std::size_t size = sums_ - begin;
      for (const Chain* chain : group) node.points.push_back(chain->point);
      const auto share_alike = [&](const Chain& a, const Chain& b) {
        return a.stages[depth] == b.stages[depth];
      };
      for (const std::vector<const Chain*>& alike : grouped(group, share_alike)) {
        node.reweightings.push_back({alike.front()->stages[depth], {}, node.reweightings.size() * size});
        for (const Chain* chain : alike) node.reweightings.back().points.push_back(chain->point);
      }
      sums_ = begin + node.reweightings.size() * size;
      nodes.push_back(std::move(node));
    }
    return nodes;
  }

  /// Groups chains by their stage at `depth` and goes on behind it.
  std::vector<PlanNode> merge(const std::vector<const Chain*>& chains, std::size_t depth) {
    if (std::all_of(chains.begin(), chains.end(), [&](const Chain* c) { return splits_at(*c, depth); }))
      return merge_reweightings(chains, depth);
    std::vector<const Chain*> going_on;
    for (const Chain* chain : chains)
      if (chain->stages.size() > depth) going_on.push_back(chain);
    const std::vector<std::vector<const Chain*>> groups =
        grouped(going_on, [&](const Chain& a, const Chain& b) { return a.stages[depth] == b.stages[depth]; });
    // Points that differ in what is looked at, and not in what happens, go on together.
    const bool look_apart =
        groups.size() > 1 && std::all_of(chains.begin(), chains.end(), [&](const Chain* c) {
          return c->stages.size() > depth && traits_of(c->stages[depth]).only_reads;
        });
    std::vector<PlanNode> nodes;
    for (const auto& group : groups) {
      if (splits_at(*group.front(), depth)) {
        for (PlanNode& node : merge_reweightings(group, depth)) nodes.push_back(std::move(node));
        continue;
      }
      PlanNode node{group.front()->stages[depth], {}, sums_, {}};
      for (const Chain* chain : group) node.points.push_back(chain->point);
      add_sums(node);
      if (!look_apart) node.next = merge(group, depth + 1);
      nodes.push_back(std::move(node));
    }
    if (look_apart)
      for (PlanNode& node : merge(chains, depth + 1)) nodes.push_back(std::move(node));
    return nodes;
  }

 private:
  template <class Alike>
  std::vector<std::vector<const Chain*>> grouped(const std::vector<const Chain*>& chains, Alike alike) {
    std::vector<std::vector<const Chain*>> groups;
    neighbours_.clear();
    for (const Chain* chain : chains) {
      const auto point = static_cast<std::size_t>(chain->point);
      std::size_t group =
          neighbours_.find(point, [&](std::size_t g) { return alike(*groups[g].front(), *chain); });
      if (group == Neighbours::none) {
        group = groups.size();
        groups.emplace_back();
      }
      groups[group].push_back(chain);
      neighbours_.put(point, group);
    }
    return groups;
  }

  void add_sums(PlanNode& node) {
    sums_ += sums_needed(node.stage);
    if (ledger_levels_ == 0 || !traits_of(node.stage).ends_particles) return;
    node.ledger = sums_;
    sums_ += LedgerSums{ledger_levels_}.size();
  }

  std::size_t sums_;
  const std::size_t ledger_levels_;
  Neighbours& neighbours_;
};

/// For a particle of that slowness [s/m].
double ways_booked(const PlanNode& node, double slowness) {
  const auto known =
      std::ranges::find_if(node.classes, [&](const SlownessClass& one) { return slowness <= one.last; });
  if (known == node.classes.end()) return static_cast<double>(node.reweightings.size());
  return static_cast<double>(nodes_in(*known));
}

double cost_of_branch(const PlanNode& node, double speed) {
  const double sum = cost_of(node.stage, speed);
  double behind = 0;
  for (const PlanNode& next : node.next) behind += cost_of_branch(next, speed);
  if (node.reweightings.empty()) return sum + behind;
  const double levels = path_of(node.stage)->outcomes();
  if (node.transit) return levels * (behind + levels * cost::moment);
  return levels * behind + ways_booked(node, 1 / speed) * (levels * cost::share + sum);
}

double cost_of_tree(const PlanTree& tree) {
  double cost = cost::emission;
  for (const PlanNode& node : tree.next) cost += cost_of_branch(node, tree.source.speed.mean);
  return std::isfinite(cost) ? cost : 1.0;  // [s] particles are dealt out by cost
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
  SpeedRange speeds;
  std::vector<Chain> chains;
};

std::vector<Group> group_by_source(const Experiment& experiment, const Neighbours& apart,
                                   SampledTables& tables) {
  const ScreenGrids grids = screen_grids(experiment.points);
  std::vector<Neighbours> of_component;
  std::vector<Group> groups;
  for (std::size_t p = 0; p < experiment.points.size(); ++p) {
    const Beamline& beamline = experiment.points[p];
    of_component.resize(std::max(of_component.size(), beamline.species.size()), apart);
    const auto first = shares(beamline);
    const std::uint32_t stream = experiment.particles == ScanParticles::shared
                                     ? 0
                                     : static_cast<std::uint32_t>(experiment.first + p) + 1;
    for (std::size_t k = 0; k < beamline.species.size(); ++k) {
      if (first[k] == first[k + 1]) continue;
      const Component& component = beamline.species[k];
      const Root root{static_cast<int>(k), first[k], first[k + 1],
                      emission_of(beamline, component, {beamline.seed, stream}, tables)};
      std::size_t group =
          stream != 0 ? Neighbours::none
                      : of_component[k].find(p, [&](std::size_t g) { return groups[g].root == root; });
      if (group == Neighbours::none) {
        group = groups.size();
        const double mass = component.species.mass;
        groups.push_back({root, speed_range(beamline.source.speed, mass), {}});
      }
      of_component[k].put(p, group);
      groups[group].chains.push_back({static_cast<int>(p), compile(beamline, component, grids, tables),
                                      component.species.structure.has_value()});
    }
  }
  return groups;
}

/// Levels matter to what becomes of particles where magnets separate them, and where atoms have them. What a
/// polarizer prepares anew does not end in the level that it was emitted in.
std::size_t ledger_levels_of(const Root& root, const std::vector<const Chain*>& chains, bool of_atom) {
  bool separated = false;
  for (const Chain* chain : chains)
    for (const Stage& stage : chain->stages) {
      const LevelEffect effect = traits_of(stage).levels;
      if (effect == LevelEffect::replaced) return 0;
      separated = separated || effect == LevelEffect::separated;
    }
  return separated || of_atom ? static_cast<std::size_t>(root.source.spin.levels) : 0;
}

void add_reachable(const SpinPath& projection, std::vector<std::uint64_t>& levels) {
  levels.resize(static_cast<std::size_t>(projection.levels));
  for (std::size_t from = 0; from < levels.size(); ++from) {
    if (projection.way != nullptr) {
      levels[from] |= projection.way->reachable_from(static_cast<int>(from));
      continue;
    }
    if (projection.transitions == nullptr) {
      levels[from] = (std::uint64_t{1} << projection.outcomes()) - 1;
      continue;
    }
    levels[from] |= projection.transitions->reachable_from(static_cast<int>(from));
  }
}

void find_reachable_levels(PlanNode& node) {
  for (const PlanNode::Reweighting& one : node.reweightings)
    add_reachable(*path_of(one.stage), node.reachable_levels);
  for (PlanNode& next : node.next) find_reachable_levels(next);
}

PlanTree make_tree(const Root& root, const std::vector<const Chain*>& chains, Neighbours& neighbours,
                   std::size_t& sums) {
  PlanTree tree;
  tree.component = root.component;
  tree.first = root.first;
  tree.last = root.last;
  tree.source = root.source;
  for (const Chain* chain : chains) tree.points.push_back(chain->point);
  const bool of_atom = std::any_of(chains.begin(), chains.end(), [](const Chain* c) { return c->of_atom; });
  tree.sums = sums;
  sums += sums_of(root.source).size();
  tree.ledger_levels = ledger_levels_of(root, chains, of_atom);
  tree.ledger = sums;
  sums += tree.ledger_levels;
  TreeMaker maker(sums, tree.ledger_levels, neighbours);
  tree.next = maker.merge(chains, 0);
  sums = maker.end_of_sums();
  for (PlanNode& node : tree.next) find_reachable_levels(node);
  return tree;
}

/// Where filters that were gathered stand, or else the first of each chain.
template <class F>
void each_filter(std::vector<PlanNode>& nodes, F f) {
  for (PlanNode& node : nodes)
    if (std::holds_alternative<Filter>(node.stage) ||
        (!node.reweightings.empty() && !path_of(node.stage)->filters.empty()))
      f(node);
    else
      each_filter(node.next, f);
}

/// The points of one source, in one flight.
class TreePlanner {
 public:
  TreePlanner(const Group& group, int points, const MomentsWanted& wanted, Neighbours& neighbours)
      : group_(group), points_(points), wanted_(wanted), neighbours_(neighbours) {}

  /// What filters let pass follows from moments where it can. Sums begin at `sums`, and `place` is the number
  /// of the next place that keeps moments.
  PlanTree plan(const std::vector<const Chain*>& chains, std::size_t& sums, std::size_t& place) {
    std::string_view why_not;
    if (auto tree = with_gathered_filters(chains, sums, place, why_not)) return std::move(*tree);
    PlanTree tree = make_tree(group_.root, chains, neighbours_, sums);
    if (points_ > 1) each_filter(tree.next, [&](PlanNode& node) { node.why_one_by_one = why_not; });
    lay_out_moments(tree, group_.speeds, {points_, wanted_, place}, sums);
    return tree;
  }

 private:
  std::optional<PlanTree> with_gathered_filters(const std::vector<const Chain*>& chains, std::size_t& sums,
                                                std::size_t& place, std::string_view& why_not) {
    std::vector<Chain> gathered;
    for (const Chain* chain : chains) {
      gathered.push_back({chain->point,
                          rabiline::with_gathered_filters(chain->stages, group_.root.source.spin, why_not),
                          chain->of_atom});
      if (gathered.back().stages.empty()) return {};
    }
    std::vector<const Chain*> pointers;
    pointers.reserve(gathered.size());
    for (const Chain& chain : gathered) pointers.push_back(&chain);
    std::size_t own_sums = sums, own_place = place;
    PlanTree tree = make_tree(group_.root, pointers, neighbours_, own_sums);
    lay_out_moments(tree, group_.speeds, {points_, wanted_, own_place}, own_sums);
    bool follow = true;
    each_filter(tree.next, [&](const PlanNode& node) {
      if (node.transit) return;
      follow = false;
      why_not = node.why_one_by_one;
    });
    if (!follow) return {};
    sums = own_sums;
    place = own_place;
    return tree;
  }

  const Group& group_;
  const int points_;
  const MomentsWanted& wanted_;
  Neighbours& neighbours_;
};

std::size_t most_memory(const std::vector<PlanNode>& nodes) {
  std::size_t most = 0;
  for (const PlanNode& node : nodes) most = std::max({most, own_memory(node.stage), most_memory(node.next)});
  return most;
}

}  // namespace

std::size_t bytes_of_stages(const Plan& plan) {
  std::size_t most = 0;
  for (const PlanTree& tree : plan.trees) most = std::max(most, most_memory(tree.next));
  return most;
}

Plan make_plan(const Experiment& experiment, int threads, double most_cost, const MomentsWanted& wanted) {
  Plan plan;
  plan.points = static_cast<int>(experiment.points.size());
  const auto tables = std::make_shared<SampledTables>();
  plan.tables = tables;
  Neighbours neighbours(experiment);
  const std::vector<Group> groups = group_by_source(experiment, neighbours, *tables);
  tables->work_out_transitions(threads);
  std::size_t place = 0;  // of those that keep moments
  for (const Group& group : groups) {
    std::vector<const Chain*> chains;
    for (const Chain& chain : group.chains) chains.push_back(&chain);
    TreePlanner planner(group, plan.points, wanted, neighbours);
    const auto whole_tree = [&](const std::vector<const Chain*>& of, std::size_t& sums, std::size_t& at) {
      PlanTree tree = planner.plan(of, sums, at);
      lay_out_frequency_nodes(tree, *tables, group.speeds, threads, sums);
      tree.cost = cost_of_tree(tree);
      return tree;
    };
    std::size_t sums = plan.sums, at = place;
    std::optional<PlanTree> whole = whole_tree(chains, sums, at);
    std::string_view why_not;
    // Parts of one flight would each fly all of it.
    const auto parts =
        is_one_flight(*whole, plan.points, why_not)
            ? 1
            : std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(64 * whole->cost / most_cost)), 1,
                                      chains.size());
    if (parts == 1) {
      plan.trees.push_back(std::move(*whole));
      plan.sums = sums;
      place = at;
      continue;
    }
    whole.reset();  // before its parts take as much memory
    for (std::size_t i = 0; i < parts; ++i) {
      const auto begin = chains.begin() + static_cast<std::ptrdiff_t>(chains.size() * i / parts);
      const auto end = chains.begin() + static_cast<std::ptrdiff_t>(chains.size() * (i + 1) / parts);
      plan.trees.push_back(whole_tree({begin, end}, plan.sums, place));
    }
  }
  return plan;
}

}  // namespace rabiline
