// Steps of levels through a Hamiltonian that changes.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>

#include "level_step_kernels.hpp"

namespace rabiline::test::level_step_test {
namespace {

using State = std::array<std::complex<double>, 3>;

/// da/dt = -i H a.
State derivative(double t, double coupled, const State& a) {
  const auto now = swings([&](double rate, double phase) { return std::cos(rate * t + phase); }, coupled);
  constexpr std::complex<double> minus_i(0, -1);
  State out;
  for (std::size_t k = 0; k < 3; ++k) out[k] = minus_i * now.energy[k] * a[k];
  for (std::size_t k = 0; k < 2; ++k) {
    const std::complex<double> up(now.re[k], now.im[k]);
    out[k + 1] += minus_i * up * a[k];
    out[k] += minus_i * std::conj(up) * a[k + 1];
  }
  return out;
}
/// By Runge and Kutta, in many steps.
State integrated(double coupled) {
  constexpr int steps = 6000;
  constexpr double h = 3.0 / steps;
  State a{1, 0, 0};
  const auto moved = [](const State& from, double by, const State& along) {
    State to = from;
    for (std::size_t k = 0; k < 3; ++k) to[k] += by * along[k];
    return to;
  };
  for (int i = 0; i < steps; ++i) {
    const double t = h * i;
    const State k1 = derivative(t, coupled, a), k2 = derivative(t + h / 2, coupled, moved(a, h / 2, k1)),
                k3 = derivative(t + h / 2, coupled, moved(a, h / 2, k2)),
                k4 = derivative(t + h, coupled, moved(a, h, k3));
    a = moved(moved(moved(moved(a, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
  }
  return a;
}
double apart(const SteppedLevels& one, const State& other) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) sum += std::norm(std::complex<double>(one.re[k], one.im[k]) - other[k]);
  return std::sqrt(sum);
}

TEST(LevelStep, IsOfSixthOrderAndKnowsWhatItIsOffBy) {
  for (const double coupled : {1.0, 0.1, 0.05, 0.02, 0.005}) {
    const State exact = integrated(coupled);
    for (const bool taken_out : {false, true}) {
      const SteppedLevels coarse = kernel::step_levels(best_isa())(4, coupled, taken_out),
                          fine = kernel::step_levels(best_isa())(8, coupled, taken_out);
      EXPECT_GT(std::log2(apart(coarse, exact) / apart(fine, exact)), 5.5) << coupled << taken_out;
      EXPECT_LT(apart(coarse, exact), coarse.error) << coupled << taken_out;
      EXPECT_LT(apart(fine, exact), fine.error) << coupled << taken_out;
    }
  }
}

}  // namespace
}  // namespace rabiline::test::level_step_test
