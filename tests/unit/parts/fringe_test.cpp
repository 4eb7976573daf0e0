// Fields of several kinds between edges that are not hard.
#include "parts/fringe.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "parts/guide_field.hpp"
#include "parts/multipole_field.hpp"
#include "parts/polarizer.hpp"
#include "parts/uniform_field.hpp"
#include "section/section_builder.hpp"

namespace rabiline::fringe_test {
namespace {

constexpr double begin = 0.4, length = 0.2, edge = begin + length, soft = 0.008;

template <class Part>
FieldHere<double> field_of(const Part& part, const Vector3& r) {
  SectionBuilder builder(Wall{});
  contribute(part, {"B", begin, {}}, builder);
  FieldHere<double> sum{};
  for (const Section& section : builder.build().sections) {
    if (r.y < section.begin || r.y > section.end) continue;
    sum.field[0] += section.field.x, sum.field[1] += section.field.y, sum.field[2] += section.field.z;
    for (const ShapedTerm& term : section.shaped) add_field<HostMaths>(term, r.x, r.y, r.z, sum);
    break;
  }
  return sum;
}
double share(double y) {
  return 0.25 * (1 + std::tanh((y - begin) / soft)) * (1 - std::tanh((y - edge) / soft));
}
double difference(const FieldHere<double>& a, const FieldHere<double>& b) {
  double most = 0;
  for (int i = 0; i < 3; ++i) most = std::max(most, std::abs(a.field[i] - b.field[i]));
  return most;
}
/// Divergence, curl, and slopes against differences of B, in parts of `unit` [T/m].
template <class Part>
double breach_of_maxwell(const Part& part, const Vector3& r, double unit) {
  const FieldHere<double> here = field_of(part, r);
  const double* s = here.slope;
  double worst = std::max(
      {std::abs(s[0] + s[4] + s[8]), std::abs(s[1] - s[3]), std::abs(s[2] - s[6]), std::abs(s[5] - s[7])});
  constexpr double h = 2e-5;
  const Vector3 steps[] = {{h, 0, 0}, {0, h, 0}, {0, 0, h}};
  for (int k = 0; k < 3; ++k) {
    const auto a = field_of(part, r + steps[k]), b = field_of(part, r - steps[k]),
               c = field_of(part, r + 2.0 * steps[k]), d = field_of(part, r - 2.0 * steps[k]);
    for (int i = 0; i < 3; ++i)
      worst = std::max(
          worst,
          std::abs((8 * (a.field[i] - b.field[i]) - (c.field[i] - d.field[i])) / (12 * h) - s[3 * i + k]));
  }
  return worst / unit;
}

UniformField growing(UnitVector direction, Tilt tilt, double field) {
  UniformField part{length, field, {}};
  part.direction = direction;
  part.tilt = tilt;
  part.gradient = {0.1, -0.2, 0.3};
  part.offset = {0.001, -0.002};
  return part;
}

TEST(Fringe, EndsAFieldThatGrowsFromPlaceToPlace) {
  for (const UnitVector direction : {UnitVector{0, 0, 1}, UnitVector{0.6, 0, -0.8}, UnitVector{0, -1, 0}})
    for (const Tilt tilt : {Tilt{}, Tilt{0.2, -0.3, 0.4}})
      for (const double field : {1e-2, 0.0}) {
        const UniformField hard = growing(direction, tilt, field);
        UniformField part = hard;
        part.fringe = TanhFringe{soft};
        for (const double y : {0.48, 0.5, 0.53})
          EXPECT_LT(difference(field_of(part, {0.003, y, 0.001}), field_of(hard, {0.003, y, 0.001})), 1e-8);
        EXPECT_LT(breach_of_maxwell(part, {0.002, edge - 0.003, 0.001}, 1), 2e-7);
        EXPECT_LT(breach_of_maxwell(part, {-0.001, begin + 0.005, -0.003}, 1), 2e-7);
        const FieldHere<double> on_axis = field_of(part, {0.001, 0.59, -0.002}),
                                whole = field_of(hard, {0.001, 0.59, -0.002});
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(on_axis.field[i], share(0.59) * whole.field[i], 1e-15);
      }
}

TEST(Fringe, OfAGradientMayBeAProfile) {
  const UniformField hard = growing({0, 0, 1}, {}, 1e-2);
  UniformField part = hard;
  part.profile = HalfSineProfile{};
  const FieldHere<double> on_axis = field_of(part, {0.001, 0.45, -0.002});
  EXPECT_NEAR(on_axis.field[2], std::sqrt(0.5) * field_of(hard, {0.001, 0.45, -0.002}).field[2], 1e-16);
  EXPECT_LT(breach_of_maxwell(part, {0.006, 0.43, 0.01}, 0.3), 1e-8);
}

TEST(Fringe, EndsAFieldThatTurnsAlongTheBeam) {
  GuideField part{length, 1e-3, {0, 0.6, 0.8}, {1, 0, 0}, {}, {}, {}};
  part.fringe = TanhFringe{soft};
  for (const double y : {0.39, 0.4, 0.41, 0.5, 0.56, 0.607}) {
    const double angle = std::numbers::pi / 2 * (y - begin) / length;
    const double expected[] = {std::sin(angle), 0.6 * std::cos(angle), 0.8 * std::cos(angle)};
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(field_of(part, {0, y, 0}).field[i], 1e-3 * share(y) * expected[i], 1e-17) << y;
  }
  EXPECT_LT(breach_of_maxwell(part, {0.002, 0.402, -0.001}, 1e-3 / soft), 2e-8);
  part.fringe = HardFringe{};
  part.profile = GaussianProfile{0.05};
  EXPECT_LT(breach_of_maxwell(part, {0.02, 0.45, -0.01}, 1e-3 / soft), 2e-8);
  part.to = part.from;
  EXPECT_NEAR(field_of(part, {0, 0.55, 0}).field[1], 0.6e-3 * std::exp(-0.5), 1e-17);
}

/// Phi = B_0/(n R^(n-1)) Re(z + i x)^n g, g the mean of F(y + i r cos t) with the weight (sin t)^(2n).
double potential_of(const MultipoleField& part, const Vector3& r) {
  constexpr int places = 2000;
  const int n = static_cast<int>(part.poles) / 2;
  const double radius = std::hypot(r.x, r.z);
  double sum = 0, all = 0;
  for (int i = 0; i < places; ++i) {
    const double t = std::numbers::pi * (i + 0.5) / places, weight = std::pow(std::sin(t), 2 * n);
    const std::complex<double> y{r.y, radius * std::cos(t)};
    sum +=
        weight * (0.25 * (1.0 + std::tanh((y - begin) / soft)) * (1.0 - std::tanh((y - edge) / soft))).real();
    all += weight;
  }
  return part.field / (n * std::pow(part.radius, n - 1)) *
         std::pow(std::complex<double>{r.z, r.x}, n).real() * sum / all;
}

TEST(Fringe, OfTiltedPolesEndsWhereItsOwnEdgeDoes) {
  MultipoleField part{length, 4, 0.1, 0.005};
  part.fringe = SineFringe{soft};
  const double behind = edge + soft / 2 + 2e-4, side = 0.004;
  const auto most = [&] {
    return std::max(difference(field_of(part, {0, behind, side}), {}),
                    difference(field_of(part, {0, behind, -side}), {}));
  };
  EXPECT_EQ(most(), 0);
  part.tilt.x = 0.2;  // one side comes 0.8 mm farther
  EXPECT_GT(most(), 1e-4);
}

TEST(Fringe, OfPolesIsTheGradientOfTheirPotential) {
  for (const std::uint64_t poles : {4, 6, 12}) {
    MultipoleField part{length, poles, 0.1, 0.005};
    const MultipoleField hard = part;
    part.fringe = TanhFringe{soft};
    EXPECT_LT(difference(field_of(part, {0.003, 0.5, 0.002}), field_of(hard, {0.003, 0.5, 0.002})), 1e-10);
    const double h = 1e-4;
    for (const Vector3 r : {Vector3{0.002, edge + 0.001, 0.003}, Vector3{-0.003, begin - 0.004, 0.001}}) {
      const FieldHere<double> f = field_of(part, r);
      const Vector3 steps[] = {{h, 0, 0}, {0, h, 0}, {0, 0, h}};
      for (int k = 0; k < 3; ++k) {
        const auto at = [&](double by) { return potential_of(part, r + by * steps[k]); };
        EXPECT_NEAR(f.field[k], (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h), 3e-7) << poles << k;
      }
      EXPECT_LT(breach_of_maxwell(part, r, 0.1 / soft), 1e-8);
    }
    // Nothing, and nothing odd, on the axis.
    for (const double component : field_of(part, {0, edge, 0}).field) EXPECT_EQ(component, 0);
    EXPECT_LT(breach_of_maxwell(part, {1e-9, edge, 0}, 0.1 / soft), 1e-6);
  }
}

TEST(Fringe, OfPolesObeysMaxwellsEquationsUnderEveryCurve) {
  MultipoleField part{0.012, 6, 0.1, 0.005};  // so short that both edges are felt everywhere
  const auto breach = [&] { return breach_of_maxwell(part, {0.0011, begin + 0.004, 0.0007}, 0.1 / soft); };
  for (const Fringe& fringe :
       std::vector<Fringe>{TanhFringe{soft}, EngeFringe{.length = soft}, SineFringe{0.01}}) {
    part.fringe = fringe;
    EXPECT_LT(breach(), 2e-7);
  }
  part.fringe = HardFringe{};
  for (const AmplitudeProfile& profile :
       std::vector<AmplitudeProfile>{HalfSineProfile{}, GaussianProfile{soft}}) {
    part.profile = profile;
    EXPECT_LT(breach(), 2e-7);
  }
}

TEST(Fringe, OfPolesMaySwing) {
  MultipoleField part{length, 4, 0.1, 0.005};
  part.fringe = TanhFringe{soft};
  part.oscillates = TimeFactor{.frequency = 1e4, .phase = {}};
  SectionBuilder builder(Wall{});
  contribute(part, {"Q", begin, {}}, builder);
  const std::vector<Section> sections = builder.build().sections;
  ASSERT_EQ(sections.size(), 1U);
  ASSERT_EQ(sections[0].swinging.size(), 1U);
  EXPECT_EQ(sections[0].swinging[0].field.kind, ShapedKind::fringed);
}

TEST(Fringe, EndsThePolarizersField) {
  Polarizer part;
  part.length = length, part.field = 1e-2;
  part.fringe = TanhFringe{soft};
  EXPECT_NEAR(field_of(part, {0, edge, 0}).field[2], 5e-3, 1e-15);
  EXPECT_LT(breach_of_maxwell(part, {0.001, edge, 0.002}, 1e-2 / soft), 1e-8);
}

TEST(Fringe, WithoutAnEndIsRefusedOfEveryField) {
  const EngeFringe endless{.length = 0.01, .a1 = -1};
  GuideField guide{length, 1e-3, {0, 0, 1}, {1, 0, 0}, {}, {}, {}};
  guide.fringe = endless;
  MultipoleField poles{length, 4, 0.1, 0.005};
  poles.fringe = endless;
  Polarizer polarizer;
  polarizer.length = length, polarizer.field = 1e-2;
  polarizer.fringe = endless;
  EXPECT_EQ(faults_of(guide, {"B", begin, {}}).at(0).key, "fringe");
  EXPECT_EQ(faults_of(poles, {"B", begin, {}}).at(0).key, "fringe");
  EXPECT_EQ(faults_of(polarizer, {"B", begin, {}}).at(0).key, "fringe");
  poles.profile = HalfSineProfile{};
  EXPECT_EQ(faults_of(poles, {"B", begin, {}}).at(0).key, "profile");
}

}  // namespace
}  // namespace rabiline::fringe_test
