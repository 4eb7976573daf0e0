// Euler angles of the spin along the path (M. Dorado's eqs. 51-72), from tallies inside of the fields.
#include <gtest/gtest.h>

#include <cmath>

#include "constants.hpp"
#include "physics/agreement.hpp"
#include "physics/independent.hpp"
#include "physics/suggested.hpp"

namespace rabiline::test::spin_angles_test {
namespace {

constexpr double b_field = 0.1e-3, h0_field = 4.8e-6, begin = 0.35, length = 0.4;
constexpr std::size_t planes = 81;

/// B' aligns, then B and in it H0 in resonance, with a monitor of 81 planes through all of H0.
Beamline path(Law law, double sigma) {
  Beamline b = suggested(-gamma_n * b_field / (2 * pi), h0_field);
  b.law = law;
  b.chamber.reset();
  b.source.speed = sigma == 0 ? SpeedLaw{SingleSpeed{1000}} : SpeedLaw{GaussianSpeed{1000, sigma}};
  b.particles = sigma == 0 ? 8 : 4000;
  b.parts[1] = place("B", 0.30, UniformField{0.45, b_field, {}});
  RotatingField h0 = std::get<RotatingField>(b.parts[2].part);
  h0.length = length;
  h0.phase = {Phase::Kind::locked, 0};
  b.parts[2] = place("H0", begin, h0);
  Monitor look{Disc{1}, {}};
  look.length = length;
  look.planes = planes;
  TallyAxis along = axis(Quantity::spin, -1, 1, 1);
  along.axis = UnitVector{};
  look.tallies = {{"clock", {axis(Quantity::time_of_flight, 0.3e-3, 0.9e-3, 1)}},
                  {"polar", {axis(Quantity::spin_polar_angle, 2.7, pi, 1)}},
                  {"azimuth", {axis(Quantity::spin_azimuth, -pi, pi, 1)}},
                  {"along", {along}}};
  b.parts.insert(b.parts.end() - 1, place("path", begin, look));
  return b;
}

/// A straight line through values with errors, or with equal weights where there are none.
struct Line {
  double slope, error;
};
Line line_through(const std::vector<double>& t, const std::vector<double>& values,
                  std::vector<double> errors) {
  for (double& e : errors) e = e > 0 ? e : 1e-7;  // what the steps of the moments leave
  double s = 0, st = 0, sv = 0;
  for (std::size_t i = 1; i < t.size(); ++i) {
    const double w = 1 / (errors[i] * errors[i]);
    s += w;
    st += w * t[i];
    sv += w * values[i];
  }
  double top = 0, bottom = 0;
  for (std::size_t i = 1; i < t.size(); ++i) {
    const double w = 1 / (errors[i] * errors[i]);
    top += w * (t[i] - st / s) * (values[i] - sv / s);
    bottom += w * (t[i] - st / s) * (t[i] - st / s);
  }
  return {top / bottom, 1 / std::sqrt(bottom)};
}
std::vector<double> unwrapped(std::vector<double> angles) {
  for (std::size_t i = 2; i < angles.size(); ++i)  // the first plane has no azimuth
    angles[i] = angles[i - 1] + std::remainder(angles[i] - angles[i - 1], 2 * pi);
  return angles;
}

TEST(SpinAngles, FallAndTurnOnResonanceWithGammaH0AndMinusGammaBUnderEveryVectorLaw) {
  for (const Law& law : {Law{ClassicalLaw{}}, Law{DoradoLaw{}}, Law{DoradoLaw{Closure::torque, 0}}})
    for (const double sigma : {0.0, 10.0}) {
      const Result r = run_points({path(law, sigma)});
      const TallyAxisResult &clock = r.tallies.at(0).axes.at(1), &polar = r.tallies.at(1).axes.at(1),
                            &azimuth = r.tallies.at(2).axes.at(1);
      const Line theta = line_through(clock.mean, polar.mean, polar.mean_errors),
                 phi = line_through(clock.mean, unwrapped(azimuth.mean), azimuth.mean_errors);
      // Of one speed the angles are exact: what is left is the width of the moments' steps.
      const double exact = 1e-6;
      expect_agreement(
          theta.slope, [](double s) { return -s * std::abs(gamma_n) * h0_field; },
          sigma == 0 ? exact * std::abs(gamma_n) * h0_field : 3 * theta.error, "theta");
      expect_agreement(
          phi.slope, [](double s) { return -s * gamma_n * b_field; },
          sigma == 0 ? exact * std::abs(gamma_n) * b_field : 3 * phi.error, "phi");
      EXPECT_NEAR(polar.mean[0], pi, 1e-6) << "S starts against the field";
      EXPECT_NEAR(azimuth.mean[0], 0, 1e-6) << "no azimuth yet";
      // H0 stands at the angle omega t: the spin leaves -z a quarter turn ahead of it.
      if (sigma == 0) {
        EXPECT_NEAR(std::remainder(azimuth.mean[1] + gamma_n * b_field * clock.mean[1] - pi / 2, 2 * pi), 0,
                    1e-6);
      }
      for (const double passed : r.monitors.at(0).passed) EXPECT_EQ(passed, 1);
    }
}

TEST(SpinAngles, GiveTheEnergyInBAlongThePath) {
  // E = -mu.B = -gamma (hbar/2) B cos(theta), eq. 72 with the sign of a moment's energy, against S_z.
  const Result r = run_points({path(DoradoLaw{}, 0)});
  const std::vector<double>&t = r.tallies.at(0).axes.at(1).mean, &polar = r.tallies.at(1).axes.at(1).mean,
        &along = r.tallies.at(3).axes.at(1).mean;
  const double unit = gamma_n * hbar / 2 * b_field;
  for (std::size_t i = 0; i < planes; ++i) {
    EXPECT_NEAR(-unit * std::cos(polar[i]), -unit * along[i], 1e-6 * std::abs(unit));
    const auto expected = [&](double s) {
      return -unit * std::cos(pi - s * std::abs(gamma_n) * h0_field * (t[i] - t[0]));
    };
    if (i > planes / 2)
      expect_agreement(-unit * along[i], expected, 1e-6 * std::abs(unit), "energy");
    else
      EXPECT_NEAR(-unit * along[i], expected(1), 1e-6 * std::abs(unit));
  }
  EXPECT_NEAR(-unit * along[0], -9.66e-31, 0.01e-31);
}

TEST(SpinAngles, AreSeenInARegionAsAnIndependentIntegrationHasThem) {
  const Beamline b = path(DoradoLaw{}, 0);
  const Result r = run_points({b});
  const auto deviation = [&](double scale) {
    const Hypothesis fields{scale * gamma_n, b_field, h0_field, -gamma_n * b_field, 0, 1, true};
    Integrator integrator(fields);
    double worst = 0;
    Motion m{begin / 1000, {0, begin, 0}, {0, 1000, 0}, {0, 0, -1}};
    for (std::size_t i = 1; i < planes; ++i) {
      m = integrator.to_plane(begin + length * static_cast<double>(i) / (planes - 1), m);
      const double theta = std::acos(m.s[2]), phi = std::atan2(m.s[1], m.s[0]);
      worst = std::max({worst, std::abs(r.tallies.at(0).axes.at(1).mean.at(i) - m.t) / 1e-3,
                        std::abs(r.tallies.at(1).axes.at(1).mean.at(i) - theta),
                        std::abs(std::remainder(r.tallies.at(2).axes.at(1).mean.at(i) - phi, 2 * pi))});
    }
    return worst;
  };
  EXPECT_LT(deviation(1), 2e-6);
  EXPECT_GT(deviation(1.01), 1e-3) << "a gamma off by 1 % must show";
}

}  // namespace
}  // namespace rabiline::test::spin_angles_test
