#include "particle/channel.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/portable_math.hpp"

namespace rabiline {
namespace {

// All lengths in radii. Share of what leaves a ring of wall by the cosine law that reaches a disc at distance
// d, and of what leaves the disc that hits the ring, per area: F(d) = (d^2+2)/(2 sqrt(d^2+4)) - d/2.
// Ring to ring, per length: K = -dF/dd. H is the integral of F.
double ring_to_disc(double d) { return (d * d + 2) / (2 * std::sqrt(d * d + 4)) - d / 2; }
double integral_of_ring_to_disc(double d) { return d * (std::sqrt(d * d + 4) - d) / 4; }
double disc_to_disc(double d) { return (d * d + 2 - d * std::sqrt(d * d + 4)) / 2; }

/// P with P'' = K on both sides of zero, and P'.
double twice_integrated(double d) { return std::abs(d) / 2 - integral_of_ring_to_disc(std::abs(d)); }
double once_integrated(double d) { return std::copysign(0.5 - ring_to_disc(std::abs(d)), d); }

/// Points from both ends, ever farther apart: the rate bends most near them. The last of a half is L/2.
std::vector<double> mesh(double length) {
  constexpr double growth = 1.03;
  const double widest = std::max(0.05, length / 500);
  std::vector<double> half{0};
  for (double step = std::min(0.002, length / 400); half.back() + step < length / 2;
       step = std::min(growth * step, widest))
    half.push_back(half.back() + step);
  const double stretch = length / 2 / half.back();
  std::vector<double> x;
  x.reserve(2 * half.size());
  for (const double h : half) x.push_back(h * stretch);
  for (std::size_t i = half.size() - 1; i-- > 0;) x.push_back(length - half[i] * stretch);
  return x;
}

/// Solves a x = b in place (Gauss, with pivots).
void solve_linear(std::vector<std::vector<double>>& a, std::vector<double>& b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    std::swap(a[k], a[pivot]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const double f = a[i][k] / a[k][k];
      for (std::size_t j = k; j < n; ++j) a[i][j] -= f * a[k][j];
      b[i] -= f * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
}

/// Share of a disc that it has in common with itself moved across by 2q radii, 0 <= q <= 1.
double overlap(double q) {
  return 2 / std::numbers::pi * (portable::acos(q) - q * std::sqrt(std::max(0.0, 1 - q * q)));
}

}  // namespace

ChannelFlow::ChannelFlow(double length_over_radius) : length_(length_over_radius) { solve(); }

// Clausing's equation eta(x) = F(x) + int_0^L K(|x - x'|) eta(x') dx', with eta linear between the points of
// the mesh: the integrals of K with such hats are exact, differences of P. eta(L - x) = 1 - eta(x) leaves the
// points of one half as unknowns, and 1/2 in the middle.
void ChannelFlow::solve() {
  x_ = mesh(length_);
  const std::size_t n = x_.size(), half = n / 2;
  std::vector<std::vector<double>> a(half, std::vector<double>(half, 0.0));
  rate_.resize(half);
  for (std::size_t i = 0; i < half; ++i) {
    rate_[i] = ring_to_disc(x_[i]);
    a[i][i] = 1;
    for (std::size_t k = 0; k < n; ++k) {
      const double d = x_[i] - x_[k], here = twice_integrated(d);
      double hat = 0;
      if (k > 0)
        hat += (twice_integrated(x_[i] - x_[k - 1]) - here) / (x_[k] - x_[k - 1]);
      else
        hat += once_integrated(d);
      if (k + 1 < n)
        hat += (twice_integrated(x_[i] - x_[k + 1]) - here) / (x_[k + 1] - x_[k]);
      else
        hat -= once_integrated(d);
      if (k < half)
        a[i][k] -= hat;
      else if (k == half)
        rate_[i] += 0.5 * hat;
      else {
        a[i][n - 1 - k] += hat;
        rate_[i] += hat;
      }
    }
  }
  solve_linear(a, rate_);
  rate_.push_back(0.5);
  for (std::size_t i = half; i-- > 0;) rate_.push_back(1 - rate_[i]);

  // W = disc to disc + 2 int eta(x) F(L - x) dx, three points of Gauss in each cell.
  static constexpr double node[] = {0.11270166537925831, 0.5, 0.88729833462074169},
                          weight[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  transmission_ = disc_to_disc(length_);
  for (std::size_t i = 0; i + 1 < n; ++i)
    for (int k = 0; k < 3; ++k)
      transmission_ += 2 * weight[k] * (x_[i + 1] - x_[i]) * std::lerp(rate_[i], rate_[i + 1], node[k]) *
                       ring_to_disc(length_ - std::lerp(x_[i], x_[i + 1], node[k]));
}

double ChannelFlow::wall_rate(double x) const {
  const auto above = std::upper_bound(x_.begin() + 1, x_.end() - 1, x);
  const auto i = static_cast<std::size_t>(above - x_.begin()) - 1;
  return std::lerp(rate_[i], rate_[i + 1], (x - x_[i]) / (x_[i + 1] - x_[i]));
}

// Seen from the exit at an angle theta: the entrance through what it has in common with the exit moved by
// L tan(theta), and the wall at distance s before the exit through what is lost between s and s + ds. With
// q = s tan(theta)/2: j = overlap(p) + (4/pi) int_0^min(p,1) sqrt(1-q^2) eta(L - 2q/tan(theta)) dq,
// p = L tan(theta)/2. q = sin(phi) makes the integrand smooth; Simpson's rule.
double ChannelFlow::angular(double tangent) const {
  const double p = length_ * tangent / 2;
  if (p == 0) return 1;
  const double last = portable::asin(std::min(p, 1.0));
  constexpr int intervals = 128;
  double sum = 0;
  for (int i = 0; i <= intervals; ++i) {
    const double phi = last * i / intervals, c = portable::cos(phi);
    const int w = i == 0 || i == intervals ? 1 : i % 2 ? 4 : 2;
    sum += w * c * c * wall_rate(std::max(0.0, length_ - 2 * portable::sin(phi) / tangent));
  }
  return (p < 1 ? overlap(p) : 0) + 4 / std::numbers::pi * sum * last / (3.0 * intervals);
}

}  // namespace rabiline
