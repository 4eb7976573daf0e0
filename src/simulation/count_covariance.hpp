#pragma once
// How the counts of scan points go together that fly the same particles, from moments of their slowness.
#include "plan/plan.hpp"
#include "simulation/transit_nodes.hpp"

namespace rabiline {

/// Of what one screen, or one plane of a monitor, counted at all points of a projection.
struct CountCovariance {
  int part = 0;  // whose it is, at the first point
  int plane = 0;
  std::vector<Eigen::Index> reweighting_of{};  // [points]
  Eigen::VectorXd of_reweightings{};           // particles^2
  Eigen::MatrixXd between_reweightings{};      // the same; empty where there are more than anybody asks for
  double between(std::size_t a, std::size_t b) const {
    return reweighting_of[a] == reweighting_of[b]
               ? of_reweightings(reweighting_of[a])
               : between_reweightings(reweighting_of[a], reweighting_of[b]);
  }
};

/// Of a link behind the projection. `counted`: particles, of each one; `stragglers`: those among them that
/// are in no cell, in each group of particles.
CountCovariance covariance_of(const PlanTree&, const PlanNode& projection, const TransitNodes&,
                              std::size_t link, const TransitNodes::WholeLink&,
                              const Eigen::VectorXd& counted, const Eigen::MatrixXd& stragglers, const Sums&,
                              int threads);

}  // namespace rabiline
