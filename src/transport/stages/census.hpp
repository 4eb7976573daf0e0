#pragma once
// A plane of a monitor.
#include <memory>

#include "transport/kernels.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

/// Counts what flies through a monitor's face in one of its planes.
struct Census {
  Aperture face;
  int part = 0;
  int plane = 0;
  bool operator==(const Census&) const = default;

  static constexpr StageTraits traits{.only_reads = true};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
  std::unique_ptr<PathTally> tally_paths() const;
};
static_assert(StageKind<Census>);

}  // namespace rabiline
