// Every law that particles start by, against its distribution.
#include <gsl/gsl_cdf.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "unit/transport/emitted.hpp"

namespace rabiline::emission_test {
namespace {

using test::emitted;
using test::expect_law;
using test::particles;
using test::speed_of;

Emission base() {
  Emission e;
  e.key = {1938, 0};
  e.speed.mean = 1000;
  e.opening.half_x = 1e-3;
  e.opening.half_z = 2e-3;
  return e;
}

Emission aimed(double y, double half_x, double half_z) {
  Emission e = base();
  e.direction.kind = DirectionKind::aimed;
  e.target.y = y;
  e.target.half_x = half_x;
  e.target.half_z = half_z;
  return e;
}

Emission gaussian() {
  Emission e = base();
  e.speed.kind = SpeedKind::gaussian;
  e.speed.centre = 1000;
  e.speed.sigma = 50;
  return e;
}

TEST(Emission, DrawsGaussianSpeeds) {
  expect_law(emitted(gaussian(), speed_of),
             [](double v, double s) { return gsl_cdf_gaussian_P(v - 1000, s * 50); });
}

TEST(Emission, GivesAParticleTheSameSpeedWhereverItsBatchBegins) {
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
    if (!supported(isa)) continue;
    Batch all, some;
    all.view().count = all.view().padded = Batch::capacity;
    kernel::emit(isa)(gaussian(), 1000, all.view());
    for (const int first : {0, 1, 2, 7, 8, 100, 255})
      for (const int count : {1, 2, 8, 17, 250}) {
        some.view().count = count;
        some.view().padded = (count + 7) / 8 * 8;
        kernel::emit(isa)(gaussian(), 1000 + static_cast<std::uint64_t>(first), some.view());
        for (int i = 0; i < count; ++i)
          ASSERT_EQ(some.view().vy[i], all.view().vy[first + i]) << first << ", " << count;
      }
  }
}

TEST(Emission, CorrelatesTheSpeedsOfNeighboursWithNothing) {
  const std::vector<double> v = emitted(gaussian(), speed_of);
  const double n = static_cast<double>(v.size());
  for (const std::size_t apart : {1, 2, 3}) {
    double sum = 0, of_squares = 0;
    for (std::size_t i = 0; i + apart < v.size(); ++i) {
      const double a = (v[i] - 1000) / 50, b = (v[i + apart] - 1000) / 50;
      sum += a * b;
      of_squares += (a * a - 1) * (b * b - 1) / 2;
    }
    EXPECT_LT(std::abs(sum), 4.5 * std::sqrt(n)) << apart;
    EXPECT_LT(std::abs(of_squares), 4.5 * std::sqrt(n)) << apart;
  }
}

TEST(Emission, CutsAWideGaussianAtZeroSpeed) {
  Emission e = base();
  e.speed.kind = SpeedKind::gaussian;
  e.speed.centre = 1000;
  e.speed.sigma = 2000;
  const std::vector<double> values = emitted(e, speed_of);
  EXPECT_GT(*std::min_element(values.begin(), values.end()), 0);
  expect_law(values, [](double v, double s) {
    const double cut = gsl_cdf_gaussian_P(-1000, s * 2000);
    return (gsl_cdf_gaussian_P(v - 1000, s * 2000) - cut) / (1 - cut);
  });
}

TEST(Emission, FillsARectangleUniformly) {
  expect_law(emitted(base(), [](const BatchView& b, int i) { return b.x[i]; }),
             [](double x, double s) { return (x / (s * 1e-3) + 1) / 2; });
  expect_law(emitted(base(), [](const BatchView& b, int i) { return b.z[i]; }),
             [](double z, double s) { return (z / (s * 2e-3) + 1) / 2; });
}

TEST(Emission, FillsADiscUniformly) {
  Emission e = base();
  e.opening.radius = 3e-3;
  expect_law(emitted(e, [](const BatchView& b, int i) { return std::hypot(b.x[i], b.z[i]); }),
             [](double r, double s) { return std::min(1.0, std::pow(r / (s * 3e-3), 2)); });
}

TEST(Emission, DrawsGaussianSlopesOfTheirOwnWidthInXAndZ) {
  Emission e = base();
  e.direction.kind = DirectionKind::gaussian;
  e.direction.spread_x = 1e-3;
  e.direction.spread_z = 4e-3;
  expect_law(emitted(e, [](const BatchView& b, int i) { return b.vx[i] / b.vy[i]; }),
             [](double slope, double s) { return gsl_cdf_gaussian_P(slope, s * 1e-3); });
  expect_law(emitted(e, [](const BatchView& b, int i) { return b.vz[i] / b.vy[i]; }),
             [](double slope, double s) { return gsl_cdf_gaussian_P(slope, s * 4e-3); });
  for (const double v : emitted(e, speed_of)) ASSERT_NEAR(v, 1000, 1e-9);
}

TEST(Emission, FillsAConeUniformlyInSolidAngle) {
  Emission e = base();
  const double half = 0.3;
  e.direction.kind = DirectionKind::cone;
  e.direction.spread_x = 1 - std::cos(half);
  expect_law(
      emitted(e, [](const BatchView& b, int i) { return b.vy[i] / speed_of(b, i); }),
      [&](double cosine, double s) { return std::max(0.0, 1 - (1 - cosine) / (1 - std::cos(s * half))); });
}

TEST(Emission, OfUnpolarisedSpinsIsIsotropicForVectorsAndUniformOverLevels) {
  expect_law(emitted(base(), [](const BatchView& b, int i) { return b.sz[i]; }),
             [](double z, double s) { return (z / s + 1) / 2; });
  Emission e = base();
  e.spin.levels = 4;
  std::vector<double> count(4, 0.0);
  for (const double level :
       emitted(e, [](const BatchView&b, int i) { return static_cast<double>(b.level[i]); }))
    count[static_cast<std::size_t>(level)] += 1;
  for (const double n : count) EXPECT_NEAR(n, particles / 4.0, 4 * std::sqrt(particles * 3 / 16.0));
}

TEST(Emission, AimedAtAnOpeningHitsItAndWeighsByTheCubeOfTheCosine) {
  Emission e = aimed(0.01, 3e-3, 4e-3);
  e.target.x0 = 2e-3;
  for (const double x :
       emitted(e, [](const BatchView&b, int i) { return b.x[i] + b.vx[i] / b.vy[i] * 0.01; })) {
    ASSERT_LE(std::abs(x - 2e-3), 3e-3 + 1e-15);
  }
  for (const double off : emitted(e, [](const BatchView&b, int i) {
         const double cosine = b.vy[i] / speed_of(b, i);
         return static_cast<double>(b.weight[i]) / static_cast<double>(quanta_per_particle) -
                cosine * cosine * cosine;
       }))
    ASSERT_NEAR(off, 0, 1e-12);
}

TEST(Emission, AimedInFreeFallHitsItAlongAParabolaAndWeighsByHowTheWaysSpread) {
  Emission e = aimed(0.5, 30e-3, 40e-3);
  e.target.x0 = 20e-3;
  e.fall = {4, -9.81};
  e.speed.mean = 5;
  // Where a slope leads to at one speed.
  const auto lands = [&](double v, double start, double slope, double other, double g) {
    const double t = e.target.y / v * std::sqrt(1 + slope * slope + other * other);
    return start + slope * e.target.y + g * t * t / 2;
  };
  for (const double off : emitted(e, [&](const BatchView&b, int i) {
         const double v = speed_of(b, i), sx = b.vx[i] / b.vy[i], sz = b.vz[i] / b.vy[i], h = 1e-5;
         const double xx = lands(v, 0, sx + h, sz, 4) - lands(v, 0, sx - h, sz, 4),
                      xz = lands(v, 0, sx, sz + h, 4) - lands(v, 0, sx, sz - h, 4),
                      zz = lands(v, 0, sz + h, sx, -9.81) - lands(v, 0, sz - h, sx, -9.81),
                      zx = lands(v, 0, sz, sx + h, -9.81) - lands(v, 0, sz, sx - h, -9.81);
         const double spread = (xx * zz - xz * zx) / std::pow(2 * h * e.target.y, 2);
         return static_cast<double>(b.weight[i]) / static_cast<double>(quanta_per_particle) -
                std::pow(b.vy[i] / v, 3) / spread;
       }))
    ASSERT_NEAR(off, 0, 1e-8);
  const std::vector<double> z = emitted(e, [&](const BatchView& b, int i) {
    return lands(speed_of(b, i), b.z[i], b.vz[i] / b.vy[i], b.vx[i] / b.vy[i], -9.81);
  });
  expect_law(z, [](double at, double s) { return std::clamp((at / (40e-3 * s) + 1) / 2, 0.0, 1.0); });
  EXPECT_LE(*std::ranges::max_element(z), 40e-3 + 1e-12);
}

TEST(Emission, AimedAtWhatItCannotReachInFreeFallHasNoWeight) {
  Emission e = aimed(3, 1e-3, 1e-3);
  e.fall = {0, -9.81};
  e.speed.mean = 5;  // reaches v^2/g = 2.5 m
  for (const double weight :
       emitted(e, [](const BatchView&b, int i) { return static_cast<double>(b.weight[i]); }))
    ASSERT_EQ(weight, 0);
}

TEST(Emission, GivesAParticleTheSameStartInAnyBatchAndOnAnyInstructionSet) {
  Emission e = base();
  e.speed.kind = SpeedKind::gaussian;
  e.speed.centre = 1000;
  e.speed.sigma = 50;
  e.direction.kind = DirectionKind::cone;
  e.direction.spread_x = 0.01;
  Batch whole, alone;
  whole.view().count = whole.view().padded = 256;
  kernel::emit(best_isa())(e, 1000, whole.view());
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
    if (!supported(isa)) continue;
    alone.view().count = 1;
    alone.view().padded = 8;
    kernel::emit(isa)(e, 1077, alone.view());
    EXPECT_EQ(alone.view().x[0], whole.view().x[77]);
    EXPECT_EQ(alone.view().vx[0], whole.view().vx[77]);
    EXPECT_EQ(alone.view().vy[0], whole.view().vy[77]);
    EXPECT_EQ(alone.view().sx[0], whole.view().sx[77]);
  }
}

}  // namespace
}  // namespace rabiline::emission_test
