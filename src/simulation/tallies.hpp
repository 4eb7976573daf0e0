#pragma once
// Where in the sums of a plan each tally stands.
#include <string_view>
#include <vector>

#include "plan/plan.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

/// Where the sums of a stage begin, and for which points they are.
struct TallyPlace {
  const PlanTree* tree;
  std::size_t at;
  const std::vector<int>* points;
  bool by_moments;  // of the slowness, behind a projection: groups are empty
};
struct ScreenTally : TallyPlace {
  int part;
  ScreenSums layout;
};
struct LevelTally : TallyPlace {
  int part;
  int component;  // of the beam
  int levels;
};
struct CensusTally : TallyPlace {
  int part;
  int plane;  // of the monitor
};
struct HistogramTally : TallyPlace {
  int part;
  int tally;  // its number in the part's list
  int plane;  // of the monitor
  HistogramSums layout;
};
struct FateTally : TallyPlace {
  std::string_view fate;
  int part;            // no_part where it does not apply
  int component;       // of the beam
  std::size_t ledger;  // where LedgerSums begin, or 0
  std::size_t levels;  // of the ledger
};

/// Every tally of a plan, found by walking its trees.
class Tallies : private SumSink {
 public:
  std::vector<ScreenTally> screens;
  std::vector<LevelTally> level_tallies;
  std::vector<FateTally> fates;
  std::vector<CensusTally> censuses;
  std::vector<HistogramTally> histograms;

  explicit Tallies(const Plan&);

 private:
  void visit(const PlanNode&);
  void visit_reweighted(const PlanNode&, const PlanNode::Reweighting&);
  void list(const Stage&, std::size_t sums, std::size_t ledger, const std::vector<int>& points);
  TallyPlace place(std::size_t at) const { return {tree_, sums_ + at, points_, by_moments_}; }

  void fate(std::string_view word, int part, std::size_t at) override;
  void screen(int part, const ScreenSums& layout, std::size_t at) override;
  void levels(int part, int levels, std::size_t at) override;
  void plane(int part, int plane, std::size_t at) override;
  void histogram(int part, int tally, int plane, const HistogramSums& layout, std::size_t at) override;

  // of the stage at hand
  const PlanTree* tree_ = nullptr;
  std::size_t sums_ = 0, ledger_ = 0;
  const std::vector<int>* points_ = nullptr;
  bool by_moments_ = false;
};

}  // namespace rabiline
