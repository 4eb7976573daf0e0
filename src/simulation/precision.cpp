#include "simulation/precision.hpp"

#include <algorithm>
#include <limits>

#include "simulation/line_centre.hpp"
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

double Reached::over(const Until& wanted) const {
  double most = 0;
  if (wanted.detected_error) most = std::max(most, detected_error / *wanted.detected_error);
  if (wanted.centre_error) most = std::max(most, centre_error / wanted.centre_error->value);
  return most;
}

Reached reached_by(const Result& result, const Until& wanted) {
  Reached reached;
  for (const DetectorResult& detector : result.detectors)
    for (const double error : detector.detected_errors)
      reached.detected_error = std::max(reached.detected_error, error);
  if (!wanted.centre_error) return reached;
  reached.centre_error = std::numeric_limits<double>::infinity();
  for (const DetectorResult& detector : result.detectors)
    reached.centre_error =
        std::min(reached.centre_error, error_of_centre(result.axes.front().values, detector));
  return reached;
}

int Precision::halvings() const {
  return is_wanted() ? most_halvings(experiment_.points.front().particles) : 0;
}

bool Precision::is_enough(const Result& result) {
  const Until& wanted = *experiment_.points.front().until;
  const Reached found = reached_by(result, wanted);
  detected_error_ = found.detected_error;
  centre_error_ = found.centre_error;
  return found.over(wanted) <= 1;
}

}  // namespace rabiline
