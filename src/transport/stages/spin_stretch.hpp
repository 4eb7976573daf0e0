#pragma once
// The levels of what a detector caught.
#include <memory>

#include "transport/spin_path.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

/// After the fields of a straight flight. Changes nothing in the batch, so that scan points that differ only
/// here share everything else.
struct SpinStretch {
  int part = 0;           // the detector
  bool majorana = false;  // quantum
  SpinPath spins;
  bool operator==(const SpinStretch&) const = default;

  static constexpr StageTraits traits{.only_reads = true, .counts_levels = true};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
  const SpinPath* path() const { return &spins; }
  int reads_catch_of() const { return part; }
  std::unique_ptr<PathTally> tally_paths() const;
};
static_assert(StageKind<SpinStretch>);

}  // namespace rabiline
