#include "field/fringed_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "checks.hpp"
#include "field/fringe_limit.hpp"

namespace rabiline::test::fringed_field_test {
namespace {

constexpr double pi = 3.14159265358979, size = 1e-3, half_length = 0.1, fringe = 0.02;
ShapedTerm fringed(bool along, FringeCurve edge) {
  return ShapedTerm(FringeShape{
      along ? FringeKind::along : FringeKind::across, edge, size, half_length, fringe, {0, 2, 0, 0, 0, 0}});
}
template <class Place>
Place tanh_share(Place z) {
  return 0.25 * (1.0 + std::tanh((z + half_length) / fringe)) * (1.0 - std::tanh((z - half_length) / fringe));
}

TEST(FringedField, FallsAsItsCurveSaysOnTheAxis) {
  for (const double z : {-0.13, -0.1, -0.05, 0.0, 0.09, 0.1, 0.14}) {
    EXPECT_NEAR(field_at(fringed(false, FringeCurve::enge), {0, 0, z}).field[0], size * tanh_share(z), 1e-17);
    EXPECT_NEAR(field_at(fringed(true, FringeCurve::enge), {0, 0, z}).field[2], size * tanh_share(z), 1e-17);
  }
  const ShapedTerm sine = fringed(false, FringeCurve::sine);
  EXPECT_EQ(field_at(sine, {0, 0, 0.0899}).field[0], size);
  EXPECT_DOUBLE_EQ(field_at(sine, {0, 0, 0.1}).field[0], size / 2);
  EXPECT_NEAR(field_at(sine, {0, 0, 0.105}).field[0], size / 2 * (1 - std::sqrt(0.5)), 1e-17);
  EXPECT_EQ(field_at(sine, {0, 0, 0.1101}).field[0], 0);
}

TEST(FringedField, RunsAsItsProfileSaysOnTheAxis) {
  for (const double z : {-0.1001, -0.07, 0.0, 0.03, 0.0999}) {
    const double inside = std::abs(z) < half_length ? 1 : 0;
    EXPECT_NEAR(field_at(fringed(false, FringeCurve::half_sine), {0, 0, z}).field[0],
                inside * size * std::cos(pi * z / (2 * half_length)), 1e-17);
    EXPECT_NEAR(field_at(fringed(true, FringeCurve::gaussian), {0, 0, z}).field[2],
                inside * size * std::exp(-z * z / (2 * fringe * fringe)), 1e-17);
  }
}

TEST(FringedField, AlongTheBeamIsTheMeanOfItsCurveOverComplexPlaces) {
  const ShapedTerm term = fringed(true, FringeCurve::enge);
  const auto off = [&](double r) {
    constexpr int places = 400;
    const double z = half_length + 0.3 * fringe;
    double along = 0, out = 0;
    for (int i = 0; i < places; ++i) {
      const double cosine = std::cos(pi * (i + 0.5) / places);
      const std::complex<double> f = tanh_share(std::complex<double>{z, r * cosine});
      along += size * f.real() / places;
      out -= size * cosine * f.imag() / places;
    }
    const Here f = field_at(term, {0.6 * r, 0.8 * r, z});
    return std::max({std::abs(f.field[2] - along), std::abs(f.field[0] - 0.6 * out),
                     std::abs(f.field[1] - 0.8 * out)}) /
           size;
  };
  EXPECT_LT(off(0), 1e-14);
  EXPECT_LT(off(1e-7 * fringe), 1e-14);
  EXPECT_LT(off(0.4 * fringe), 1e-10);
  EXPECT_LT(off(0.8 * fringe), 2e-5);  // (r/d)^16, the pole at d = 1.6 lengths
  EXPECT_LT(off(good_up_to(term.fringed)), 0.01);
}

TEST(FringedField, AlongTheBeamObeysMaxwellsEquationsBesideTheAxis) {
  for (const FringeCurve curve :
       {FringeCurve::enge, FringeCurve::sine, FringeCurve::half_sine, FringeCurve::gaussian}) {
    const ShapedTerm term = fringed(true, curve);
    EXPECT_LT(slope_error(term, {0.24 * fringe, 0.32 * fringe, 0.105}, 2e-5) / (size / fringe), 3e-8);
    EXPECT_LT(std::abs(divergence(field_at(term, {0.003, 0.004, 0.11}))), 1e-14);
  }
}

TEST(FringedField, AlongTheBeamIsBesselsWhereItsCurveIsACosine) {
  // B_z = B_0 cos(k z) I_0(k r), B_r = B_0 sin(k z) I_1(k r).
  const double k = pi / (2 * half_length), z = 0.03;
  for (const double kr : {1e-6, 0.01, 0.3, 1.5}) {
    const double r = kr / k;
    const Here f = field_at(fringed(true, FringeCurve::half_sine), {0.6 * r, 0.8 * r, z});
    const double i0 = std::cyl_bessel_i(0, kr), i1 = std::cyl_bessel_i(1, kr);
    EXPECT_NEAR(f.field[2] / (size * std::cos(k * z) * i0), 1, 1e-13);
    EXPECT_NEAR(f.field[0] / (0.6 * size * std::sin(k * z) * i1), 1, 1e-11);
    EXPECT_NEAR(f.slope[8] / (-k * size * std::sin(k * z) * i0), 1, 1e-13);
    EXPECT_NEAR(f.slope[2] / (0.6 * k * size * std::cos(k * z) * i1), 1, 1e-11);
  }
}

/// Two wires 4 mm beside each other's middle, 5 mm below the axis.
ShapedTerm wires(double length) {
  FringeShape shape{FringeKind::wires, FringeCurve::enge, size, half_length, length, {0, 2, 0, 0, 0, 0}};
  shape.half_distance = 4e-3;
  shape.height = 5e-3;
  return ShapedTerm(shape);
}

TEST(FringedWires, HaveTheirClosedFormFarInside) {
  const ShapedTerm term = wires(2e-3);
  const double distance = std::hypot(4e-3, 5e-3);
  for (const double x : {-1.5e-3, 0.0, 1e-3})
    for (const double y : {-1.2e-3, 0.0, 1.6e-3}) {
      const double x1 = y - 4e-3, x2 = y + 4e-3, z = 5e-3 + x;  // magnet_shape.hpp: from each wire
      const double r1 = x1 * x1 + z * z, r2 = x2 * x2 + z * z, b0 = size * distance * distance / (2 * 4e-3);
      const Here f = field_at(term, {x, y, 0.01});
      const double left_out = std::pow(std::hypot(x, y) / distance, 16) + 1e-12;
      EXPECT_NEAR(f.field[0], b0 * (x2 / r2 - x1 / r1), 4 * left_out * size);
      EXPECT_NEAR(f.field[1], b0 * z * (1 / r1 - 1 / r2), 4 * left_out * size);
      EXPECT_NEAR(f.field[2], 0, 1e-12 * size);
    }
}

TEST(FringedWires, RiseOnTheAxisAsTheirCurve) {
  for (const double z : {0.0, 0.09, 0.1, 0.12})
    EXPECT_NEAR(field_at(wires(fringe), {0, 0, z}).field[0], size * tanh_share(z), 1e-12 * size);
}

TEST(FringedWires, ObeyMaxwellsEquationsBesideTheAxis) {
  const ShapedTerm term = wires(4e-3);
  for (const double z : {0.095, 0.1, 0.104})
    for (const double x : {-1e-3, 0.0, 1.2e-3}) {
      EXPECT_LT(slope_error(term, {x, 0.8e-3, z}, 1e-5) / (size / 4e-3), 1e-7) << x << " " << z;
      EXPECT_LT(std::abs(divergence(field_at(term, {x, 0.8e-3, z}))), 1e-14);
    }
}

TEST(FringedWires, AreKnownAsFarAsTheirSeriesIs) {
  EXPECT_NEAR(good_up_to(wires(0.05).fringed), std::pow(0.01, 1.0 / 16) * std::hypot(4e-3, 5e-3), 1e-9);
  EXPECT_LT(good_up_to(wires(1e-3).fringed), 1.6e-3);  // of so short an edge
}

TEST(FringedField, StaysFiniteFarAway) {
  for (const bool along : {false, true})
    for (const FringeCurve edge :
         {FringeCurve::enge, FringeCurve::sine, FringeCurve::half_sine, FringeCurve::gaussian})
      for (const double z : {-100.0, 0.0, 100.0}) {
        ShapedTerm term = fringed(along, edge);
        const double a[6] = {0.478959, 1.911289, -1.185953, 1.630554, -1.082657, 0.318111};
        for (int i = 0; i < 6; ++i) term.fringed.enge[i] = a[i];
        const Here f = field_at(term, {0.001, 0.002, z});
        for (const double b : f.field) EXPECT_TRUE(std::isfinite(b));
        for (const double g : f.slope) EXPECT_TRUE(std::isfinite(g));
        EXPECT_NEAR(f.field[along ? 2 : 0], z == 0 ? size : 0, 5e-3 * size);
      }
}

/// div B = 0 alone: what turns aside at an edge at the height x is B x, whatever the curve. Its share of
/// that.
double flux_at_an_edge(const ShapedTerm& term, double x) {
  constexpr int places = 20000;
  const double end = half_length + 12 * fringe, step = end / places;
  double sum = 0;
  for (int i = 0; i < places; ++i) sum += field_at(term, {x, 0, (i + 0.5) * step}).field[2] * step;
  return -sum / (size * x);
}

TEST(FringedField, IsGoodAsFarOutAsTheFluxThroughItsEdgeIsRightAndNoPoleIsNear) {
  const ShapedTerm sine = fringed(false, FringeCurve::sine), tanh = fringed(false, FringeCurve::enge);
  EXPECT_NEAR(flux_at_an_edge(sine, good_up_to(sine.fringed)), 1.01, 1e-3);
  const double good = good_up_to(tanh.fringed);
  EXPECT_NEAR(good, (pi - std::asin(1 / 1.5)) / 2 * fringe,
              fringe / 50);  // |1/(1 + e^2(s + ir))| <= 1/sin 2r
  EXPECT_NEAR(flux_at_an_edge(tanh, good), 1, 1e-4);
  EXPECT_LT(flux_at_an_edge(tanh, 1.02 * pi / 2 * fringe), 0.5);  // behind the pole
  ShapedTerm enge = tanh;
  const double common[6] = {0.478959, 1.911289, -1.185953, 1.630554, -1.082657, 0.318111};
  std::copy(common, common + 6, enge.fringed.enge);
  EXPECT_NEAR(flux_at_an_edge(enge, good_up_to(enge.fringed)), 1, 1e-3);
  EXPECT_LT(flux_at_an_edge(enge, 1.8 * good_up_to(enge.fringed)), 0.6);
}

TEST(FringedField, AlongTheBeamIsGoodAsFarOutAsAcrossItButForASine) {
  for (const FringeCurve curve : {FringeCurve::enge, FringeCurve::gaussian})
    EXPECT_EQ(good_up_to(fringed(true, curve).fringed), good_up_to(fringed(false, curve).fringed));
  EXPECT_NEAR(good_up_to(fringed(true, FringeCurve::half_sine).fringed),
              2 * half_length / pi * std::sqrt(0.08), 1e-12);
}

}  // namespace
}  // namespace rabiline::test::fringed_field_test
