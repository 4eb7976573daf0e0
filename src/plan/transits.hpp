#pragma once
// Which projections book moments of the slowness, so that a scan behind them costs one flight.
#include "particle/speed.hpp"
#include "plan/plan.hpp"

namespace rabiline {

struct MomentsOf {
  int points;  // of the whole scan
  const MomentsWanted& wanted;
  std::size_t& place;  // number of the next place among the wanted cells
};

/// Lays out the moments of every projection of a tree where all scan points follow from them and that is the
/// shorter way; they stand at the end of `sums`. `speeds`: of nearly all particles of the tree.
void lay_out_moments(PlanTree&, const SpeedRange& speeds, const MomentsOf&, std::size_t& sums);

/// Whether every stage serves all points of the scan, or is one whose points follow from moments. Otherwise,
/// why not.
bool is_one_flight(const PlanTree&, int points, std::string_view& why);

}  // namespace rabiline
