#pragma once
// What a source emits, against a distribution.
#include <gsl/gsl_cdf.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "core/isa.hpp"
#include "transport/kernels.hpp"

namespace rabiline::test {

constexpr int particles = 100000, cells = 50;

inline std::vector<double> emitted(const Emission& e,
                                   const std::function<double(const BatchView&, int)>& value,
                                   std::uint64_t count = particles) {
  std::vector<double> values;
  Batch batch;
  BatchView& view = batch.view();
  for (std::uint64_t first = 0; first < count; first += Batch::capacity) {
    view.count = static_cast<int>(std::min<std::uint64_t>(Batch::capacity, count - first));
    view.padded = (view.count + 7) / 8 * 8;
    kernel::emit(best_isa())(e, first, view);
    for (int i = 0; i < view.count; ++i) values.push_back(value(view, i));
  }
  return values;
}

/// p-value of a chi-square test against a distribution function, in cells of equal probability.
inline double p_value(const std::vector<double>& values, const std::function<double(double)>& cdf) {
  std::vector<double> counts(cells, 0.0);
  for (const double v : values)
    counts[static_cast<std::size_t>(std::clamp(static_cast<int>(cells * cdf(v)), 0, cells - 1))] += 1;
  const double expected = static_cast<double>(values.size()) / cells;
  double chi2 = 0;
  for (const double n : counts) chi2 += (n - expected) * (n - expected) / expected;
  return gsl_cdf_chisq_Q(chi2, cells - 1);
}

/// Fits the law, and does not fit it with a parameter that is off by 2 %.
inline void expect_law(const std::vector<double>& values, const std::function<double(double, double)>& cdf) {
  EXPECT_GT(p_value(values, [&](double v) { return cdf(v, 1); }), 0.001);
  EXPECT_LT(p_value(values, [&](double v) { return cdf(v, 1.02); }), 0.001);
}

inline double speed_of(const BatchView& b, int i) { return std::hypot(b.vx[i], b.vy[i], b.vz[i]); }

}  // namespace rabiline::test
