#include "particle/speed.hpp"

#include <gsl/gsl_integration.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "constants.hpp"
#include "core/constants.hpp"
#include "particle/law_tables.hpp"

namespace rabiline::speed_test {
namespace {

constexpr double neutron = test::neutron_mass, helium = 4.002602 * constants::atomic_mass;

double integral(const std::function<double(double)>& f, double low, double high) {
  gsl_integration_workspace* w = gsl_integration_workspace_alloc(2000);
  gsl_function g{[](double x, void* p) { return (*static_cast<const std::function<double(double)>*>(p))(x); },
                 const_cast<std::function<double(double)>*>(&f)};
  double result = 0, error = 0;
  gsl_integration_qag(&g, low, high, 0, 1e-10, 2000, GSL_INTEG_GAUSS61, w, &result, &error);
  gsl_integration_workspace_free(w);
  return result;
}
double mean_of(const std::function<double(double)>& density, double low, double high) {
  return integral([&](double v) { return v * density(v); }, low, high) / integral(density, low, high);
}

TEST(SpeedQuantity, OfAWavelengthAndAnEnergyIsTheSpeedOfThatNeutron) {
  // h/m = 3956.034 angstrom m/s; 25.3 meV is 2200 m/s, the thermal neutron of 1.798 angstrom.
  EXPECT_NEAR(speed_of({4e-10, Dimension::length}, neutron), 3956.034 / 4, 1e-3);
  EXPECT_NEAR(speed_of({25.3e-3 * constants::elementary_charge, Dimension::energy}, neutron), 2200, 0.2);
  EXPECT_NEAR(speed_of({1.7982e-10, Dimension::length}, neutron), 2200, 0.1);
  EXPECT_EQ(speed_of(1000.0, neutron), 1000);
}

TEST(SupersonicSpeed, OfHeliumAt300KelvinEndsAt1765MetresPerSecond) {
  const SupersonicSpeed beam{300, 5.0 / 3, 20};
  EXPECT_NEAR(terminal_speed(beam, helium), 1765.2, 0.05);
  EXPECT_GT(std::abs(terminal_speed({300 * 1.01, 5.0 / 3, 20}, helium) - 1765.2), 5);
}

TEST(MeanSpeed, IsThatOfEachLaw) {
  const double alpha = thermal_speed(300, helium);
  EXPECT_NEAR(mean_speed(EffusiveSpeed{300}, helium) / alpha, 1.32934, 1e-5);
  EXPECT_NEAR(mean_speed(MaxwellSpeed{300}, helium) / alpha, 1.12838, 1e-5);
  for (const double s : {1.0, 3.0, 20.0, 300.0}) {
    const SupersonicSpeed beam{300, 5.0 / 3, s};
    const double expected =
        mean_of([&](double y) { return y * y * y * std::exp(-s * s * (y - 1) * (y - 1)); },
                std::max(0.0, 1 - 9 / s), 1 + 9 / s);
    EXPECT_NEAR(mean_speed(beam, helium) / terminal_speed(beam, helium), expected, 1e-9) << s;
  }
  EXPECT_EQ(mean_speed(GaussianSpeed{1000, 10}, helium), 1000);
  EXPECT_DOUBLE_EQ(mean_speed(LineSpeeds{{{500.0, 1}, {900.0, 3}}}, helium), 800);
}

TEST(MeanSpeed, OfWavelengthsIsNotTheSpeedOfTheirMean) {
  const GaussianSpeed law{{4e-10, Dimension::length}, {0.4e-10, Dimension::length}};
  const double expected = mean_of(
      [&](double v) {
        const double lambda = constants::planck / (neutron * v), z = (lambda - 4e-10) / 0.4e-10;
        return std::exp(-z * z / 2) / (v * v);
      },
      400, 5000);
  EXPECT_NEAR(mean_speed(law, neutron) / expected, 1, 1e-5);
  EXPECT_GT(mean_speed(law, neutron), 1.009 * speed_of(law.mean, neutron));
}

TEST(MeanSpeed, OfEqualSharesOfWavelengthsAndEnergiesIsTheIntegral) {
  const double length = 4e-10, energy = 4e-21, spread = 0.6;
  const auto mean = [&](double q0, Dimension d) {
    return integral(
               [&](double q) {
                 return speed_of({q, d}, neutron);
               },
               q0 * (1 - spread), q0 * (1 + spread)) /
           (2 * spread * q0);
  };
  EXPECT_NEAR(mean_speed(UniformSpeed{{length, Dimension::length}, spread}, neutron) /
                  mean(length, Dimension::length),
              1, 1e-9);
  EXPECT_NEAR(mean_speed(UniformSpeed{{energy, Dimension::energy}, spread}, neutron) /
                  mean(energy, Dimension::energy),
              1, 1e-9);
  EXPECT_EQ(mean_speed(UniformSpeed{1000, spread}, neutron), 1000);
}

TEST(SpeedRange, HoldsAllButOneInTenThousandParticlesOfEachLaw) {
  const double alpha = thermal_speed(300, helium);
  const auto share_outside = [](const SpeedRange& range, const std::function<double(double)>& density,
                                double last) {
    return 1 - integral(density, range.slowest, range.fastest) / integral(density, 0, last);
  };
  const auto flux = [&](double v) { return std::pow(v / alpha, 3) * std::exp(-v * v / alpha / alpha); };
  const auto box = [&](double v) { return std::pow(v / alpha, 2) * std::exp(-v * v / alpha / alpha); };
  EXPECT_LT(share_outside(EffusiveSpeed{300}.speed_range(helium), flux, 12 * alpha), 1.1e-4);
  EXPECT_LT(share_outside(MaxwellSpeed{300}.speed_range(helium), box, 12 * alpha), 1.1e-4);
  const SpeedRange uniform = UniformSpeed{{4e-10, Dimension::length}, 0.1}.speed_range(neutron);
  EXPECT_DOUBLE_EQ(uniform.slowest, speed_of({4.4e-10, Dimension::length}, neutron));
  EXPECT_DOUBLE_EQ(uniform.fastest, speed_of({3.6e-10, Dimension::length}, neutron));
}

TEST(LawTables, MakeATableOnce) {
  LawTables tables;
  const SupersonicSpeed cold{77, 5.0 / 3, 8}, warm{300, 5.0 / 3, 8}, fast{300, 5.0 / 3, 9};
  EXPECT_EQ(cold.draw(helium, tables).table, warm.draw(helium, tables).table);
  EXPECT_NE(cold.draw(helium, tables).table.at, fast.draw(helium, tables).table.at);
}

TEST(MeanSpeed, OfATableIsThatOfItsLinearDensity) {
  const auto spectrum =
      std::make_shared<Spectrum>(Spectrum{"", Dimension::speed, {500, 700, 1100}, {0, 2, 1}});
  const double expected =
      mean_of([](double v) { return v < 700 ? (v - 500) / 100 : 2 - (v - 700) / 400; }, 500, 1100);
  EXPECT_NEAR(mean_speed(TabulatedSpeed{{spectrum}}, neutron), expected, 1e-3);
}

}  // namespace
}  // namespace rabiline::speed_test
