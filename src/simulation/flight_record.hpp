#pragma once
// What a flight leaves for other scans of the fields that turn spins and steer nothing.
#include <string>
#include <vector>

#include "simulation/snapshot.hpp"
#include "tally/sums.hpp"
#include "transport/transit.hpp"

namespace rabiline {

struct FlightRecord {
  /// Detectors behind projections whose bins were added up, and they and monitors whose tallies were left
  /// out.
  std::vector<std::string> totals_of;
  /// Of each place that keeps moments.
  std::vector<SlownessCells> cells;
  /// Those of the plan of one point with these cells and bins.
  Sums sums;
  std::vector<Straggler> stragglers;
  int halvings = 0;        // left when its particles were enough
  bool asked_for = false;  // kept whatever room it takes
};

}  // namespace rabiline
