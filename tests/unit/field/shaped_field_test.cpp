#include "field/shaped_field.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <vector>

#include "checks.hpp"
#include "field/lane_maths.hpp"

namespace rabiline::test::shaped_field_test {
namespace {

constexpr double pi = std::numbers::pi, mu_0 = 1.25663706127e-6;

struct Sample {
  std::string name;
  ShapedTerm term;
  bool has_curl = false;
};
std::vector<Sample> samples() {
  FringeShape tanh{FringeKind::across, FringeCurve::enge, 1e-3, 0.1, 0.05, {0, 2, 0, 0, 0, 0}}, sine = tanh;
  FringeShape half_sine = tanh, gaussian = tanh;
  sine.curve = FringeCurve::sine;
  half_sine.curve = FringeCurve::half_sine;
  gaussian.curve = FringeCurve::gaussian;
  FringeShape growing = tanh, turning = tanh;
  growing.even = 0.5, growing.growth = 3;
  turning.turn = 7, turning.phase = 0.4;
  LinearShape linear{{1e-3, 0, 2e-3}, {1e-2, 2e-2, 0, 2e-2, -3e-2, 5e-3, 0, 5e-3, 2e-2}};
  return {{"linear", ShapedTerm(linear)},
          {"loop", ShapedTerm(LoopShape{0.05, 1e-3})},
          {"sheet", ShapedTerm(SheetShape{0.05, 0.1, 1e-3})},
          {"flat sheet", ShapedTerm(FlatSheetShape{0.04, 1e-3})},
          {"wire", ShapedTerm(WireShape{1e-5, 1e-3, 0})},
          {"piece of wire", ShapedTerm(WireShape{1e-5, 1e-3, 0.1}), true},
          {"sextupole", ShapedTerm(MultipoleShape{2, 1e-3, 0.01})},
          {"tanh", ShapedTerm(tanh)},
          {"sine", ShapedTerm(sine)},
          {"half sine", ShapedTerm(half_sine)},
          {"gaussian", ShapedTerm(gaussian)},
          {"growing", ShapedTerm(growing)},
          {"turning", ShapedTerm(turning)}};
}
/// A sextupole with a fringe, of places that are none in particular.
Sample soft_poles() {
  FringeShape poles{FringeKind::poles, FringeCurve::enge, 10, 0.1, 0.05, {0, 2, 0, 0, 0, 0}};
  poles.power = 2;
  for (int i = 0; i < 4; ++i) poles.place[i] = 0.2 + 0.2 * i, poles.share[i] = 0.25;
  return {"soft poles", ShapedTerm(poles)};
}
const std::vector<Vector3> places = {
    {0.003, 0.001, 0.02}, {0, 0.02, -0.01}, {-0.02, 0.03, 0.13}, {0.03, -0.02, -0.0604}, {0.045, 0.03, 0.09}};

TEST(ShapedField, HasNeitherDivergenceNorCurlAndTheSlopesOfItsField) {
  for (const Sample& s : samples())
    for (const ShapedTerm& term : {s.term, turned_elsewhere(s.term)})
      for (const Vector3& place : places) {
        const Vector3 r = in_laboratory(term, place);
        const Here f = field_at(term, r);
        const double size = largest(f.slope) + 1e-9;
        EXPECT_LT(std::abs(divergence(f)), 1e-13 * size) << s.name;
        EXPECT_LT(curl(f), s.has_curl ? 2 * size : 1e-13 * size) << s.name;
        EXPECT_LT(slope_error(term, r, 2e-5), 1e-8 * size) << s.name << " " << place.x;
      }
}

TEST(ShapedField, IsTheSameToTheBitInLanes) {
  using namespace isa_baseline;
  std::vector<Sample> all = samples();
  all.push_back(soft_poles());
  for (const Sample& s : all) {
    const ShapedTerm term = turned_elsewhere(s.term);
    for (const Vector3& place : places) {
      const Vector3 r = in_laboratory(term, place);
      const Here one = field_at(term, r);
      FieldHere<real> many{};
      add_field<LaneMaths>(term, broadcast(r.x), broadcast(r.y), broadcast(r.z), many);
      for (int i = 0; i < 3; ++i) EXPECT_EQ(lane(many.field[i], lane_count - 1), one.field[i]) << s.name;
      for (int i = 0; i < 9; ++i) EXPECT_EQ(lane(many.slope[i], 0), one.slope[i]) << s.name;
    }
  }
}

/// Biot and Savart by the trapezoidal rule, which converges exponentially around a circle.
Vector3 field_of_ring(double radius, double current, const Vector3& r) {
  constexpr int n = 4096;
  Vector3 sum;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * pi * i / n, c = std::cos(angle), s = std::sin(angle);
    const Vector3 to = r - Vector3{radius * c, radius * s, 0}, along{-radius * s, radius * c, 0};
    sum = sum + std::pow(length_of(to), -3) * cross(along, to);
  }
  return (mu_0 * current / (2.0 * n)) * sum;
}

TEST(CurrentLoop, HasTheFieldOfBiotAndSavart) {
  const double radius = 0.05, current = 3;
  const ShapedTerm loop(LoopShape{radius, mu_0 * current / (2 * radius)});
  for (const Vector3& r : places) {
    const Vector3 expected = field_of_ring(radius, current, r);
    const Here f = field_at(loop, r);
    EXPECT_LT(length_of(Vector3{f.field[0], f.field[1], f.field[2]} - expected), 1e-12 * length_of(expected));
  }
}

TEST(CurrentLoop, HasFiniteSlopesOnItsAxis) {
  const ShapedTerm loop(LoopShape{0.05, 1e-3});
  const Here f = field_at(loop, {0, 0, 0.02});
  const double q = 1 + 0.16;  // B = B_0 q^(-3/2), q = 1 + (z/R)^2
  EXPECT_NEAR(f.field[2], 1e-3 * std::pow(q, -1.5), 1e-17);
  EXPECT_NEAR(f.slope[8], -3e-3 * 0.02 / 0.0025 * std::pow(q, -2.5), 1e-15);
  EXPECT_NEAR(f.slope[0], -f.slope[8] / 2, 1e-15);
  EXPECT_EQ(f.slope[2], 0);
}

TEST(Solenoid, IsARowOfLoops) {
  const double radius = 0.05, half = 0.1, field = 1e-3;
  const ShapedTerm sheet(SheetShape{radius, half, field});
  constexpr int n = 400;
  for (const Vector3& r : places) {
    Vector3 sum;  // Simpson
    for (int i = 0; i <= n; ++i) {
      const double at = -half + 2 * half * i / n, weight = i == 0 || i == n ? 1 : i % 2 == 0 ? 2 : 4;
      const ShapedTerm loop(LoopShape{radius, field / (2 * radius) * weight * 2 * half / (3.0 * n)});
      const Here f = field_at(loop, r - Vector3{0, 0, at});
      sum = sum + Vector3{f.field[0], f.field[1], f.field[2]};
    }
    const Here f = field_at(sheet, r);
    EXPECT_LT(length_of(Vector3{f.field[0], f.field[1], f.field[2]} - sum), 1e-7 * length_of(sum)) << r.x;
  }
}

TEST(FlatSheet, IsARowOfWires) {
  const double half = 0.04, strength = 1e-3;
  const ShapedTerm sheet(FlatSheetShape{half, strength});
  constexpr int n = 2000;
  for (const Vector3& r : places) {
    Vector3 sum;  // of the middles of narrow strips
    for (int i = 0; i < n; ++i) {
      const ShapedTerm wire(WireShape{strength * 2 * half / n, 1e-6, 0});
      const Here f = field_at(wire, r - Vector3{-half + 2 * half * (i + 0.5) / n, 0, 0});
      sum = sum + Vector3{f.field[0], f.field[1], f.field[2]};
    }
    const Here f = field_at(sheet, r);
    EXPECT_LT(length_of(Vector3{f.field[0], f.field[1], f.field[2]} - sum), 1e-4 * length_of(sum)) << r.x;
  }
}

TEST(FlatSheet, HasTheFieldOfAnEndlessOneNearByWhichJumpsAndIsZeroInIt) {
  const ShapedTerm sheet(FlatSheetShape{0.04, 1e-3});  // mu_0 K/2 = pi mT
  EXPECT_NEAR(field_at(sheet, {0, 1e-9, 5}).field[0], -pi * 1e-3, 1e-10);
  EXPECT_NEAR(field_at(sheet, {0, -1e-9, 5}).field[0], pi * 1e-3, 1e-10);
  EXPECT_EQ(field_at(sheet, {0, 0, 5}).field[0], 0);
  EXPECT_EQ(field_at(sheet, {0, 0.3, 5}).field[1], 0);
  for (const double x : {-0.04, 0.04}) {  // at an edge
    const Here edge = field_at(sheet, {x, 0, 5});
    EXPECT_LT(std::abs(edge.field[1]), 1e-3 * 15) << x;
    EXPECT_EQ(edge.field[0], 0) << x;
  }
}

TEST(StraightWire, FollowsAmperesLawInsideAndOutside) {
  const ShapedTerm wire(WireShape{mu_0 * 50 / (2 * pi), 1e-3, 0});
  EXPECT_NEAR(field_at(wire, {0.02, 0, 0.3}).field[1], 5e-4, 1e-12);  // 50 A at 20 mm
  EXPECT_NEAR(field_at(wire, {0, 0.02, 0.3}).field[0], -5e-4, 1e-12);
  EXPECT_NEAR(field_at(wire, {0.5e-3, 0, 0}).field[1], 5e-3, 1e-11);  // as 1 mm away, halved
  EXPECT_EQ(field_at(wire, {0, 0, 0}).field[0], 0);
}

TEST(StraightWire, HasTheFieldOfAPieceWhereItEnds) {
  const double half = 0.1;
  const ShapedTerm wire(WireShape{mu_0 * 50 / (2 * pi), 1e-3, half});
  // In the plane of one end: half of what the angle to the other end gives.
  const double r = 0.05, share = 0.2 / std::hypot(0.2, r) / 2;
  EXPECT_NEAR(field_at(wire, {r, 0, half}).field[1], mu_0 * 50 / (2 * pi * r) * share, 1e-15);
}

TEST(MultipoleField, PointsUpAboveItsAxisAndGrowsWithItsPower) {
  const ShapedTerm quadrupole(MultipoleShape{1, 1e-3, 0.01}), sextupole(MultipoleShape{2, 1e-3, 0.01});
  EXPECT_DOUBLE_EQ(field_at(quadrupole, {0, 5, 0.02}).field[2], 2e-3);
  EXPECT_DOUBLE_EQ(field_at(quadrupole, {0.02, 5, 0}).field[0], -2e-3);
  EXPECT_DOUBLE_EQ(field_at(sextupole, {0, 5, 0.02}).field[2], 4e-3);
  const Here f = field_at(sextupole, {0.003, 5, 0.004});
  EXPECT_DOUBLE_EQ(std::hypot(f.field[0], f.field[2]), 1e-3 * 0.25);
}

TEST(TwistedField, TurnsFromItsFirstDirectionToItsSecondAlongY) {
  constexpr double rate = 5;  // [rad/m]
  const ShapedTerm twisted(TwistedShape{{0, 0, 2e-3}, {2e-3, 0, 0}, rate});
  for (const double angle : {0.0, 0.4, pi / 2}) {
    const Here f = field_at(twisted, {0.01, angle / rate, -0.02});
    EXPECT_NEAR(f.field[0], 2e-3 * std::sin(angle), 1e-17);
    EXPECT_NEAR(f.field[2], 2e-3 * std::cos(angle), 1e-17);
    EXPECT_NEAR(f.slope[1], rate * 2e-3 * std::cos(angle), 1e-16);
    EXPECT_NEAR(f.slope[7], -rate * 2e-3 * std::sin(angle), 1e-16);
    for (const int none : {0, 2, 3, 4, 5, 6, 8}) EXPECT_EQ(f.slope[none], 0);
  }
}

}  // namespace
}  // namespace rabiline::test::shaped_field_test
