#pragma once
// The plan of a scan: every point compiles to a source and a chain of stages; equal beginnings are shared.
#include <cstdint>
#include <vector>

#include "beamline/beamline.hpp"
#include "plan/geometry.hpp"
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

/// Scan points whose particles are emitted alike. One sum, at `sums`: what was emitted.
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
  std::size_t sums = 0;  // how many in all
  int points = 0;
};

/// One scan point's chain of stages for one species.
std::vector<Stage> compile(const Beamline&, const Component&, const ScreenGrids&);
/// How the particles of a beamline start.
Emission emission_of(const Beamline&, const Component&, RandomKey);

/// `most_cost`: no tree costs more than that [s] for one batch pack of 64 particles; larger scans get
/// several.
Plan make_plan(const Experiment&, double most_cost = 0.025);

}  // namespace rabiline
