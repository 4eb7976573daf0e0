#include "simulation/precision.hpp"

#include <algorithm>

#include "simulation/finish.hpp"
#include "simulation/work.hpp"

namespace rabiline {

Experiment part_of(const Experiment& experiment, const Plan& plan, int halvings) {
  if (halvings == 0) return experiment;
  std::uint64_t particles = 0;
  for (const PlanTree& tree : plan.trees)
    if (tree.points.front() == 0) particles += last_of_part(tree, halvings) - tree.first;
  Experiment part = experiment;
  part.points = {experiment.points.size(), [points = experiment.points, particles](std::size_t p) {
                   Beamline beamline = points[p];
                   beamline.particles = particles;
                   return beamline;
                 }};
  return part;
}

double largest_error(const Result& result) {
  double largest = 0;
  for (const DetectorResult& detector : result.detectors)
    for (const double error : detector.detected_errors) largest = std::max(largest, error);
  return largest;
}

int Precision::halvings() const {
  return is_wanted() ? most_halvings(experiment_.points.front().particles) : 0;
}

bool Precision::is_enough(const Sums& sums, int halvings) {
  error_ = largest_error(finish(part_of(experiment_, plan_, halvings), part_of(plan_, halvings), sums));
  return error_ <= experiment_.points.front().until->detected_error;
}

}  // namespace rabiline
