#pragma once
// What the plan makes of a source, drawn by the kernels.
#include <gsl/gsl_integration.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "physics/suggested.hpp"
#include "unit/transport/emitted.hpp"

namespace rabiline::test {

inline Beamline beam(SpeedLaw speed, DirectionLaw direction = ParallelDirection{}) {
  Beamline b = suggested(291e3);
  b.law = QuantumLaw{};
  b.source = {std::move(speed), Rectangle{1e-3, 1e-3}, std::move(direction)};
  return b;
}

/// Draws from the source of a beamline; holds its tables.
struct Drawn {
  SampledTables tables;
  Emission emission;
  explicit Drawn(const Beamline& b) : emission(emission_of(b, b.species.front(), {1938, 0}, tables)) {}
  std::vector<double> operator()(const std::function<double(const BatchView&, int)>& value,
                                 std::uint64_t count = particles) const {
    return emitted(emission, value, count);
  }
};
inline std::vector<double> speeds_of(const SpeedLaw& law) { return Drawn(beam(law))(speed_of); }

/// The distribution function of a density, by Gauss-Kronrod in 4000 cells and linear between them.
class Cdf {
 public:
  template <class Density>
  Cdf(Density density, double low, double high) : low_(low), width_((high - low) / cells) {
    gsl_function g{[](double x, void* p) { return (*static_cast<Density*>(p))(x); }, &density};
    for (int i = 0; i < cells; ++i) {
      double part = 0, error = 0;
      std::size_t evaluations = 0;
      gsl_integration_qng(&g, low + i * width_, low + (i + 1) * width_, 1e-6, 1e-6, &part, &error,
                          &evaluations);
      sum_.push_back(sum_.back() + part);
    }
  }
  double operator()(double x) const {
    const double at = std::clamp((x - low_) / width_, 0.0, cells - 1e-9);
    const auto i = static_cast<std::size_t>(at);
    return std::lerp(sum_[i], sum_[i + 1], at - static_cast<double>(i)) / sum_.back();
  }

 private:
  static constexpr int cells = 4000;
  double low_, width_;
  std::vector<double> sum_{0.0};
};

inline double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}
/// The mean of f over what is drawn is `expected` within four standard errors, and not 2 % more.
inline void expect_mean(const std::vector<double>& values, double expected) {
  double square = 0;
  const double m = mean(values), n = static_cast<double>(values.size());
  for (const double v : values) square += (v - m) * (v - m);
  const double error = std::sqrt(square) / n;
  EXPECT_NEAR(m, expected, 4 * error);
  EXPECT_GT(std::abs(m - 1.02 * expected), 4 * error);
}

}  // namespace rabiline::test
