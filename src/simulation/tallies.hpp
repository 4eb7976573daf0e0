#pragma once
// Where in the sums of a plan each tally stands.
#include <vector>

#include "particle/fate.hpp"
#include "plan/plan.hpp"

namespace rabiline {

/// Where in the sums one screen's tallies stand, and for which points.
struct ScreenTally {
  int part;
  const PlanTree* tree;
  ScreenSums layout;
  std::size_t at;
  const std::vector<int>* points;
};
struct LevelTally {
  int part;
  int component;  // of the beam
  int levels;
  std::size_t at;
  const std::vector<int>* points;
};
struct CensusTally {
  int part;
  const PlanTree* tree;
  std::size_t at;
  const std::vector<int>* points;
};
struct HistogramTally {
  const Histogram* histogram;
  const PlanTree* tree;
  std::size_t at;
  const std::vector<int>* points;
};
struct FateTally {
  Fate fate;
  int part;  // no_part where it does not apply
  std::size_t at;
  const std::vector<int>* points;
};
constexpr int no_part = -2;

/// Every tally of a plan, found by walking its trees.
struct Tallies {
  std::vector<ScreenTally> screens;
  std::vector<LevelTally> levels;
  std::vector<FateTally> fates;
  std::vector<CensusTally> censuses;
  std::vector<HistogramTally> histograms;

  explicit Tallies(const Plan&);

 private:
  void visit(const PlanNode&);
  void add(const Drift&, const PlanNode&) {}
  void add(const Alignment&, const PlanNode&) {}
  void add(const Precession&, const PlanNode&) {}
  void add(const Filter&, const PlanNode&);
  void add(const LevelDraw&, const PlanNode&) {}
  void add(const Deflection&, const PlanNode&);
  void add(const Steering&, const PlanNode&);
  void add(const Passage&, const PlanNode&);
  void add(const Exit&, const PlanNode&);
  void add(const SpinStretch&, const PlanNode&);
  void add(const Score&, const PlanNode&);
  void add(const TurningRegion&, const PlanNode&);
  void add(const Census&, const PlanNode&);
  void add(const Histogram&, const PlanNode&);
  void add_screen(const Screen&, std::size_t at, const PlanNode&);

  const PlanTree* tree_ = nullptr;
};

}  // namespace rabiline
