#pragma once
// The plan of a scan: every point compiles to a source and a chain of stages; equal beginnings are shared.
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "beamline/beamline.hpp"
#include "plan/geometry.hpp"
#include "plan/sampled_tables.hpp"
#include "transport/stages.hpp"

namespace rabiline {

/// One stage, the scan points it serves, where its sums begin, and what follows. Stages that only read may
/// stand beside what follows them.
struct PlanNode {
  Stage stage;
  std::vector<int> points;
  std::size_t sums = 0;
  std::vector<PlanNode> next;
};

/// The sums of a source: q and q^2 of what was emitted, and where weights differ, q of every group.
struct EmissionSums {
  bool weights_differ;
  static std::size_t q() { return 0; }
  static std::size_t q2() { return 1; }
  static std::size_t group(std::size_t g) { return 2 + g; }
  std::size_t size() const { return weights_differ ? 2 + group_count : 2; }
};
inline EmissionSums sums_of(const Emission& e) { return {e.direction == DirectionKind::aimed}; }

/// Scan points whose particles are emitted alike; what was emitted stands at `sums`.
struct PlanTree {
  int component = 0;                  // index of the species in the beam
  std::uint64_t first = 0, last = 0;  // particle numbers [first, last) of that species
  Emission source;
  std::vector<int> points;
  std::size_t sums = 0;
  std::vector<PlanNode> next;
  double cost = 0;  // [s] estimated, for one particle through the tree on one core
};

struct Plan {
  std::vector<PlanTree> trees;
  std::shared_ptr<const SampledTables> tables;  // what the trees' sources and stages read
  std::size_t sums = 0;                         // how many in all
  int points = 0;
};

/// One scan point's chain of stages for one species, which the tables must outlive.
std::vector<Stage> compile(const Beamline&, const Component&, const ScreenGrids&, SampledTables&);
/// The fields along the whole beam as one species sees them.
std::vector<SpinZone> zones_along(const Beamline&, const Component&);
/// How the particles of a beamline start. What it draws from stays in the tables, which must outlive it.
Emission emission_of(const Beamline&, const Component&, RandomKey, SampledTables&);
/// Transmissions of channels that were worked out already, by length over radius.
using Transmissions = std::map<double, double>;
/// The share of all particles leaving the source that weight 1 of an aimed one stands for; 1 where it is not
/// aimed. The detected weight per particle times it is the detected share of all that leave.
double aimed_fraction(const Beamline&, Transmissions&);

/// `most_cost`: no tree costs more than that [s] for one batch pack of 64 particles; larger scans get
/// several.
Plan make_plan(const Experiment&, double most_cost = 0.025);

}  // namespace rabiline
