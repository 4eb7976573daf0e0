// Every law of speeds as the plan hands it to the kernels, drawn and held against its distribution.
#include "core/constants.hpp"
#include "unit/plan/drawn.hpp"

namespace rabiline::emission_speeds_test {
namespace {

using test::beam;
using test::Cdf;
using test::expect_law;
using test::expect_mean;
using test::neutron;
using test::particles;
using test::speeds_of;

const double alpha = thermal_speed(300, neutron().mass);

TEST(EffusiveSpeed, IsDrawnByItsLaw) {
  // y^2 of the flux has the gamma distribution of order 2, that of the density order 3/2.
  expect_law(speeds_of(EffusiveSpeed{300}),
             [](double v, double s) { return gsl_cdf_gamma_P(std::pow(v / (s * alpha), 2), 2, 1); });
}

TEST(EffusiveSpeed, HasTheMomentsOfAFlux) {
  std::vector<double> y = speeds_of(EffusiveSpeed{300}), square, inverse;
  for (double& v : y) v /= alpha;
  for (const double v : y) {
    square.push_back(v * v);
    inverse.push_back(1 / v);
  }
  expect_mean(y, 1.32934);
  expect_mean(square, 2);
  expect_mean(inverse, 0.88623);
}

TEST(MaxwellSpeed, IsDrawnByItsLaw) {
  expect_law(speeds_of(MaxwellSpeed{300}),
             [](double v, double s) { return gsl_cdf_gamma_P(std::pow(v / (s * alpha), 2), 1.5, 1); });
}

TEST(SupersonicSpeed, IsDrawnByItsLaw) {
  for (const double ratio : {1.0, 5.0, 40.0}) {
    const SupersonicSpeed law{300, 5.0 / 3, ratio};
    const double u = std::sqrt(5) * std::sqrt(constants::boltzmann * 300 / neutron().mass);
    const Cdf cdf([&](double y) { return y * y * y * std::exp(-std::pow(ratio * (y - 1), 2)); },
                  std::max(0.0, 1 - 8 / ratio), 1 + 9 / ratio);
    expect_law(speeds_of(law), [&](double v, double s) { return cdf(v / (s * u)); });
  }
}

TEST(TabulatedSpeed, IsDrawnFromTheRowsOfEachQuantity) {
  const auto cdf = [](double q) {  // of the density 0, 2, 1, 0 at 1, 2, 4, 5
    if (q < 2) return (q - 1) * (q - 1) / 4.5;
    if (q < 4) return (1 + 2 * (q - 2) - (q - 2) * (q - 2) / 4) / 4.5;
    return 1 - (5 - q) * (5 - q) / 2 / 4.5;
  };
  const auto table = [](Dimension d, double unit) {
    return TabulatedSpeed{
        {std::make_shared<Spectrum>(Spectrum{"", d, {unit, 2 * unit, 4 * unit, 5 * unit}, {0, 2, 1, 0}})}};
  };
  const double m = neutron().mass;
  expect_law(speeds_of(table(Dimension::speed, 200)),
             [&](double v, double s) { return cdf(std::clamp(v / (s * 200), 1.0, 5.0)); });
  expect_law(speeds_of(table(Dimension::length, 1e-10)), [&](double v, double s) {
    return cdf(std::clamp(constants::planck / (m * v) / (s * 1e-10), 1.0, 5.0));
  });
  expect_law(speeds_of(table(Dimension::energy, 1e-21)),
             [&](double v, double s) { return cdf(std::clamp(m * v * v / 2 / (s * 1e-21), 1.0, 5.0)); });
}

TEST(GaussianSpeed, IsNormalInTheQuantityThatIsWritten) {
  const double m = neutron().mass;
  expect_law(speeds_of(GaussianSpeed{{4e-10, Dimension::length}, {0.4e-10, Dimension::length}}),
             [&](double v, double s) {
               return gsl_cdf_gaussian_P(constants::planck / (m * v) - 4e-10, s * 0.4e-10);
             });
  expect_law(speeds_of(GaussianSpeed{{4e-21, Dimension::energy}, {1e-21, Dimension::energy}}),
             [&](double v, double s) { return gsl_cdf_gaussian_P(m * v * v / 2 - 4e-21, s * 1e-21); });
}

TEST(GaussianSpeed, InWavelengthsLeavesOutWhatWouldBeTooFast) {
  for (const double v : speeds_of(GaussianSpeed{{4e-10, Dimension::length}, {4e-10, Dimension::length}})) {
    ASSERT_GT(v, 0);
    ASSERT_LE(v, fastest_speed * (1 + 1e-12));
  }
}

TEST(UniformSpeed, IsUniformInWhatIsWritten) {
  const double up = 1.1, down = 0.9, h = constants::planck / neutron().mass;
  expect_law(speeds_of(UniformSpeed{1000, 0.1}),
             [&](double v, double s) { return std::clamp((v / s - 900) / 200, 0.0, 1.0); });
  expect_law(speeds_of(UniformSpeed{{4e-10, Dimension::length}, 0.1}), [&](double v, double s) {
    return 1 - std::clamp((s * h / v / 4e-10 - down) / (up - down), 0.0, 1.0);
  });
  expect_law(speeds_of(UniformSpeed{{4e-21, Dimension::energy}, 0.1}), [&](double v, double s) {
    return std::clamp((neutron().mass * v * v / 2 * s / 4e-21 - down) / (up - down), 0.0, 1.0);
  });
}

TEST(LineSpeeds, ComeInTheSharesOfTheirWeights) {
  const std::vector<double> speeds =
      speeds_of(LineSpeeds{{{500.0, 1}, {{4e-10, Dimension::length}, 2}, {2000.0, 5}}});
  const double second = constants::planck / (neutron().mass * 4e-10);
  double counts[3] = {};
  for (const double v : speeds) {
    ASSERT_TRUE(v == 500 || std::abs(v - second) < 1e-9 || v == 2000);
    counts[v == 500 ? 0 : v == 2000 ? 2 : 1] += 1;
  }
  for (const auto& [count, share] : {std::pair{counts[0], 0.125}, {counts[1], 0.25}, {counts[2], 0.625}})
    EXPECT_NEAR(count, share * particles, 4 * std::sqrt(particles * share * (1 - share)));
}

TEST(Emission, OfAWavelengthDependsOnTheMass) {
  const Beamline b = beam(SingleSpeed{{4e-10, Dimension::length}});
  Component heavy = b.species.front();
  heavy.species.mass *= 2;
  SampledTables tables;
  EXPECT_DOUBLE_EQ(emission_of(b, heavy, {1, 0}, tables).speed.mean * 2,
                   emission_of(b, b.species.front(), {1, 0}, tables).speed.mean);
}

}  // namespace
}  // namespace rabiline::emission_speeds_test
