#include "models/measure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/portable_math.hpp"

namespace rabiline {

std::vector<double> angles_about(const Vector3& axis, std::span<const Vector3> vectors) {
  const Vector3 e1 = some_normal(axis), e2 = cross(axis, e1);
  const auto angle = [&](const Vector3& v) { return portable::atan2(dot(e2, v), dot(e1, v)); };
  std::vector<double> out{0};
  for (std::size_t i = 1; i < vectors.size(); ++i)
    out.push_back(out.back() +
                  std::remainder(angle(vectors[i]) - angle(vectors[i - 1]), 2 * std::numbers::pi));
  return out;
}

std::optional<double> radius_of(std::span<const Vector3> places) {
  const auto count = static_cast<double>(places.size());
  Vector3 mean;
  for (const Vector3& p : places) mean = mean + (1 / count) * p;
  double size = 0;
  for (const Vector3& p : places) size = std::max(size, portable::hypot(p.x - mean.x, p.y - mean.y));
  if (!(size > 0)) return std::nullopt;
  // Sums over u, v about the mean in units of the size; the centre c solves M c = b.
  double uu = 0, uv = 0, vv = 0, bu = 0, bv = 0;
  for (const Vector3& p : places) {
    const double u = (p.x - mean.x) / size, v = (p.y - mean.y) / size, square = u * u + v * v;
    uu += u * u, uv += u * v, vv += v * v;
    bu += u * square / 2, bv += v * square / 2;
  }
  const double determinant = uu * vv - uv * uv;
  if (!(determinant > 1e-10 * uu * vv) || !(determinant > 1e-10 * count * count)) return std::nullopt;
  const double cu = (bu * vv - bv * uv) / determinant, cv = (bv * uu - bu * uv) / determinant;
  return size * std::sqrt(cu * cu + cv * cv + (uu + vv) / count);
}

double mean_rate(std::span<const double> times, std::span<const double> values) {
  const double middle = (times.front() + times.back()) / 2, length = times.back() - times.front();
  double up = 0, down = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double t = times[i] - middle,
                 weight = portable::pow(portable::cos(std::numbers::pi * t / length), 4);
    up += weight * t * values[i];
    down += weight * t * t;
  }
  return up / down;
}

double largest_change(std::span<const double> values) {
  double out = 0;
  for (const double x : values) out = std::max(out, std::abs(x - values.front()));
  return out;
}

}  // namespace rabiline
