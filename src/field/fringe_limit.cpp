#include "field/fringe_limit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/portable_math.hpp"
#include "field/host_maths.hpp"

namespace rabiline {
namespace {

constexpr double most_wrong = 0.01, most_size = 1.5;
constexpr int looks = 256;

/// The largest of the field about an edge, in parts of the whole, as complex places have it.
double size_beside(const FringeShape& shape, double distance) {
  const bool ends = shape.curve == FringeCurve::gaussian;
  const double end = shape.half_length + (ends ? 0 : 6 * shape.fringe),
               begin = ends ? 0 : std::max(0.0, shape.half_length - 6 * shape.fringe);
  double largest = 0;
  for (int i = 0; i <= looks; ++i) {
    const double z = begin + (end - begin) * i / looks;
    const ComplexNumber<double> f = edges_at<HostMaths>(shape, ComplexNumber<double>{z, distance}).value;
    largest = std::max(largest, portable::hypot(f.re, f.im, 0));
  }
  return largest;
}

}  // namespace

double series_good_up_to(const FringeShape& shape) {
  if (shape.kind != FringeKind::wires) return std::numeric_limits<double>::infinity();
  return portable::pow(most_wrong, 1.0 / 16) * portable::hypot(shape.half_distance, shape.height, 0);
}

double good_up_to(const FringeShape& shape) {
  const double most = series_good_up_to(shape);
  if (shape.curve == FringeCurve::sine || shape.curve == FringeCurve::half_sine) {
    const double length = shape.curve == FringeCurve::sine ? shape.fringe : 2 * shape.half_length;
    return std::min(
        most, length / std::numbers::pi * std::sqrt((shape.kind == FringeKind::across ? 6 : 8) * most_wrong));
  }
  const double step = shape.fringe / 64;
  double distance = 0;
  while (distance < std::min(most, 100 * shape.fringe) && size_beside(shape, distance + step) <= most_size)
    distance += step;
  return std::min(most, distance);
}

double distance_from_axis(const ShapedTerm& fringed, double x, double y, double z) {
  double own[3];
  own_place(fringed, x, y, z, own);
  return fringed.fringed.kind == FringeKind::across ? std::abs(own[0]) : portable::hypot(own[0], own[1], 0);
}

}  // namespace rabiline
