#pragma once
// How the counts of scan points go together that fly the same particles, from moments of their slowness.
#include "plan/plan.hpp"
#include "simulation/transit_nodes.hpp"

namespace rabiline {

/// Of what one screen counted at all points of a projection.
struct ScreenCovariance {
  int part = 0;                        // the screen's, at the first point
  std::vector<Eigen::Index> way_of{};  // [points]
  Eigen::VectorXd of_ways{};           // particles^2
  Eigen::MatrixXd between_ways{};      // the same; empty where there are more than anybody asks for
  double between(std::size_t a, std::size_t b) const {
    return way_of[a] == way_of[b] ? of_ways(way_of[a]) : between_ways(way_of[a], way_of[b]);
  }
};

/// Of a screen behind the projection. `share`: what it counts of each weight that it catches; `counted`:
/// particles, of each way; `stragglers`: those among them that are in no cell, in each group of particles.
ScreenCovariance covariance_of(const PlanTree&, const PlanNode& projection, const TransitNodes&,
                               const TransitNodes::WholeScreen&, double share, int part,
                               const Eigen::VectorXd& counted, const Eigen::MatrixXd& stragglers, const Sums&,
                               int threads);

}  // namespace rabiline
