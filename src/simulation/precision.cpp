#include "simulation/precision.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulation/line_centre.hpp"
#include "simulation/work.hpp"

namespace rabiline {
namespace {

/// What the error of a fraction may be: of a sample that happens to have few counts it comes out too small,
/// and a run that ended there would have a result that is too small, too. The sample counts for n =
/// p(1 - p)/error^2 of equal weight, and k = n p of these (or what is missing, if that is less) for k + 1 +
/// sqrt(k + 1): one standard error more, and one count, of which none has been seen.
double most_error(double fraction, double error) {
  const double p = std::clamp(std::min(fraction, 1 - fraction), 0.0, 1.0);
  if (!(error > 0)) return error;
  const double n = p > 0 ? p * (1 - p) / (error * error) : 0.5 / error;
  const double more = n * p + 1, most = std::min(0.5, (more + std::sqrt(more)) / n);
  return std::max(error, std::sqrt(most * (1 - most) / n));
}

}  // namespace

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
    for (std::size_t p = 0; p < detector.detected.size(); ++p)
      reached.detected_error =
          std::max(reached.detected_error, most_error(detector.detected[p], detector.detected_errors[p]));
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
