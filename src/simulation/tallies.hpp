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
  int plane;  // of the monitor
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
  int component = 0;       // of the beam
  std::size_t ledger = 0;  // where LedgerSums begin, or 0
  std::size_t levels = 0;  // of the ledger
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
  /// The sums of a stage, and the points they are for.
  struct Stand {
    std::size_t at;
    const std::vector<int>* points;
    std::size_t ledger = 0;
  };
  void visit(const PlanNode&);
  void visit_way(const PlanNode&, const PlanNode::Way&);
  void add(const Drift&, const Stand&) {}
  void add(const Alignment&, const Stand&) {}
  void add(const Precession&, const Stand&) {}
  void add(const Filter&, const Stand&);
  void add(const LevelProjection&, const Stand&) {}
  void add(const Deflection&, const Stand&);
  void add(const Steering&, const Stand&);
  void add(const Passage&, const Stand&);
  void add(const Exit&, const Stand&);
  void add(const SpinStretch&, const Stand&);
  void add(const Score&, const Stand&);
  void add(const TurningRegion&, const Stand&);
  void add(const Census&, const Stand&);
  void add(const Histogram&, const Stand&);
  void add_screen(const Screen&, const Stand&);
  void add_fate(Fate, int part, std::size_t at, const Stand&);

  const PlanTree* tree_ = nullptr;
};

}  // namespace rabiline
