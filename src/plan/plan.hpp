#pragma once
// The plan of a scan: every point compiles to a source and a chain of stages; equal beginnings are shared.
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "beamline/experiment.hpp"
#include "plan/geometry.hpp"
#include "plan/sampled_tables.hpp"
#include "transport/stage.hpp"
#include "transport/transit.hpp"

namespace rabiline {

/// Reweightings that differ in one frequency alone, and those at Chebyshev's points of its range.
struct FrequencyNodes {
  std::vector<std::size_t> reweightings{};  // that follow
  std::vector<Stage> nodes{};
  std::size_t sums = 0;  // of the first node; those of the others follow, as many as each reweighting has
  std::vector<double> weights{};  // [reweighting][node] of what was booked at each node
};
/// Particles up to a slowness [s/m], from where the class before ends. Every reweighting follows from nodes.
struct SlownessClass {
  double last = 0;
  std::vector<FrequencyNodes> families{};
};

/// One stage, the scan points it serves, where its sums begin, and what follows. Stages that only read may
/// stand beside what follows them.
struct PlanNode {
  Stage stage;
  std::vector<int> points;
  std::size_t sums = 0;
  std::vector<PlanNode> next;
  std::size_t ledger =
      0;  // where the ledger by prepared level begins; 0: the stage ends nobody, or there is none
  /// Of a stage that splits weights: paths behind it are flown once in each level, and reweighted for each
  /// setting of scan points. `next` is one chain, its sums those of the first reweighting. Of a stage that
  /// only reads: the points that it serves by moments.
  struct Reweighting {
    Stage stage;
    std::vector<int> points;
    std::size_t shift = 0;  // of its sums behind those of the first
  };
  std::vector<Reweighting> reweightings{};
  /// That any reweighting can find, as a mask for each level before.
  std::vector<std::uint64_t> reachable_levels{};
  /// Where all reweightings follow from moments of the slowness: how these are laid out, and where they
  /// begin.
  std::shared_ptr<const TransitLayout> transit{};
  std::size_t moments = 0;
  std::string_view why_one_by_one{};  // why they do not
  /// Where reweightings follow from few frequencies instead, for particles of different slowness
  /// (plan/frequency_nodes.hpp); what is slower than the last class is booked for each reweighting.
  std::vector<SlownessClass> classes{};
};

/// What particles of a class are booked at.
inline std::size_t nodes_in(const SlownessClass& one) {
  std::size_t nodes = 0;
  for (const FrequencyNodes& family : one.families) nodes += family.nodes.size();
  return nodes;
}
/// How many sums each of several reweightings has.
inline std::size_t sums_of_reweighting(const PlanNode& node) { return node.reweightings[1].shift; }

/// The sums of a source: q and q^2 of what was emitted, and where weights differ, q of every group.
struct EmissionSums {
  bool weights_differ;
  static std::size_t q() { return 0; }
  static std::size_t q2() { return 1; }
  static std::size_t group(std::size_t g) { return 2 + g; }
  std::size_t size() const { return weights_differ ? 2 + group_count : 2; }
};
inline EmissionSums sums_of(const Emission& e) { return {e.direction.kind == DirectionKind::aimed}; }

/// What becomes of the particles that were prepared in each level, at one stage [quanta]: what was caught by
/// its screen, and what ended there otherwise.
struct LedgerSums {
  std::size_t levels;
  static std::size_t caught(std::size_t level) { return 2 * level; }
  static std::size_t ended(std::size_t level) { return 2 * level + 1; }
  std::size_t size() const { return 2 * levels; }
};

/// Scan points whose particles are emitted alike; what was emitted stands at `sums`.
struct PlanTree {
  int component = 0;                  // index of the species in the beam
  std::uint64_t first = 0, last = 0;  // particle numbers [first, last) of that species
  Emission source;
  std::vector<int> points;
  std::size_t sums = 0;
  std::vector<PlanNode> next;
  std::size_t ledger_levels = 0;  // that the ledger tells apart; 0: none
  std::size_t ledger = 0;         // where what was emitted in each of them begins
  double cost = 0;                // [s] estimated, for one particle through the tree on one core
};

struct Plan {
  std::vector<PlanTree> trees;
  std::shared_ptr<const SampledTables> tables;  // what the trees' sources and stages read
  std::size_t sums = 0;                         // how many in all
  int points = 0;
};

/// The most that each thread keeps while a batch passes one stage [bytes].
std::size_t bytes_of_stages(const Plan&);

/// The beam cut at the edges of its fields; deflecting magnets are planes only where the law lets them
/// deflect.
Sections sections_of(const Beamline&);
/// One scan point's chain of stages for one species, which the tables must outlive.
std::vector<Stage> compile(const Beamline&, const Component&, const ScreenGrids&, SampledTables&);
/// The fields along the whole beam as the one moment of a species sees them; none of an atom under `quantum`.
std::vector<SpinZone> zones_along(const Beamline&, const Component&);
/// How the particles of a beamline start. What it draws from stays in the tables, which must outlive it.
Emission emission_of(const Beamline&, const Component&, RandomKey, SampledTables&);
/// The share of all particles leaving the source that weight 1 of an aimed one stands for; 1 where it is not
/// aimed. The detected weight per particle times it is the detected share of all that leave.
double aimed_fraction(const Beamline&, Transmissions&);

/// Which places keep moments of the slowness.
struct MomentsWanted {
  bool everywhere = false;  // where they can be kept, also where asking each particle is the shorter way
  /// Of each place, in the order of each_transit(), these cells; a place that they are too wide for keeps
  /// none.
  const std::vector<SlownessCells>* cells = nullptr;
};

inline constexpr double most_tree_cost = 0.025;  // [s]
/// `most_cost`: no tree costs more than that [s] for one batch pack of 64 particles; larger scans get
/// several.
/// `threads` work out what is tabulated; 0: as many as there are cores.
Plan make_plan(const Experiment&, int threads = 0, double most_cost = most_tree_cost,
               const MomentsWanted& = {});

/// Calls f with each node that keeps moments.
template <class F>
void each_transit(const std::vector<PlanNode>& nodes, F f) {
  for (const PlanNode& node : nodes)
    if (node.transit && node.next.empty()) f(node);
  for (const PlanNode& node : nodes) {
    if (!node.transit)
      each_transit(node.next, f);
    else if (!node.next.empty())
      f(node);
  }
}

}  // namespace rabiline
