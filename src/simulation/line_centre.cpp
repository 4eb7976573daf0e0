#include "simulation/line_centre.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace rabiline {
namespace {

/// A curve in the order of its axis.
class Curve {
 public:
  Curve(const std::vector<double>& x, const DetectorResult& detector)
      : detector_(detector), order_(x.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) { return x[a] < x[b]; });
    for (const std::size_t at : order_) x_.push_back(x[at]);
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(order_.size()); }
  double y(Eigen::Index i) const { return detector_.detected[at(i)]; }
  double covariance(Eigen::Index i, Eigen::Index j) const {
    if (!detector_.detected_covariance.empty())
      return detector_.detected_covariance[at(i) * order_.size() + at(j)];
    return i == j ? detector_.detected_errors[at(i)] * detector_.detected_errors[at(i)] : 0;
  }
  /// Between its neighbours, and the variance of that.
  std::pair<double, double> slope(Eigen::Index i) const {
    const Eigen::Index low = std::max<Eigen::Index>(i - 1, 0), high = std::min(i + 1, size() - 1);
    const double step = x_[static_cast<std::size_t>(high)] - x_[static_cast<std::size_t>(low)];
    return {(y(high) - y(low)) / step,
            (covariance(high, high) + covariance(low, low) - 2 * covariance(high, low)) / (step * step)};
  }

 private:
  std::size_t at(Eigen::Index i) const { return order_[static_cast<std::size_t>(i)]; }

  const DetectorResult& detector_;
  std::vector<std::size_t> order_;
  std::vector<double> x_;
};

}  // namespace

double error_of_centre(const std::vector<double>& x, const DetectorResult& detector) {
  const Curve curve(x, detector);
  Eigen::VectorXd line(curve.size()), slopes(curve.size());
  double chance = 0;
  for (Eigen::Index i = 0; i < curve.size(); ++i) {
    line(i) = curve.y(i);
    const auto [slope, variance] = curve.slope(i);
    slopes(i) = slope;
    chance += variance;
  }
  // A baseline and a height take their part of what a shift does.
  line.array() -= line.mean();
  slopes.array() -= slopes.mean();
  if (const double size2 = line.squaredNorm(); size2 > 0) slopes -= line * (line.dot(slopes) / size2);
  const double all = slopes.squaredNorm();
  if (!(chance < all / 2)) return std::numeric_limits<double>::infinity();
  double variance = 0;
  for (Eigen::Index i = 0; i < curve.size(); ++i)
    for (Eigen::Index j = 0; j < curve.size(); ++j)
      variance += slopes(i) * curve.covariance(i, j) * slopes(j);
  // Slopes that chance made steeper promise too much.
  return std::sqrt(std::max(0.0, variance)) / (all - chance);
}

}  // namespace rabiline
