#include "parts/uniform_field.hpp"

#include <gtest/gtest.h>

#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "section/section_builder.hpp"

namespace rabiline::uniform_field_test {
namespace {

constexpr double g = 1e-3;  // [T/m]

std::vector<Section> sections_of(const UniformField& part) {
  SectionBuilder builder(Wall{});
  contribute(part, {"B", 0.4, {}}, builder);
  return builder.build().sections;
}
FieldHere<double> field_in(const Section& section, const Vector3& r) {
  FieldHere<double> sum{{section.field.x, section.field.y, section.field.z}, {}};
  for (const ShapedTerm& term : section.shaped) add_field<HostMaths>(term, r.x, r.y, r.z, sum);
  return sum;
}
UniformField uniform(UnitVector direction) {
  UniformField part{0.2, 1e-2, {}};
  part.direction = direction;
  return part;
}

TEST(UniformField, WithoutGradientIsUniformToTheBit) {
  const std::vector<Section> sections = sections_of(uniform({0, 0, 1}));
  ASSERT_EQ(sections.size(), 1U);
  EXPECT_TRUE(sections[0].shaped.empty());
  EXPECT_EQ(sections[0].field, (Vector3{0, 0, 1e-2}));
}

TEST(UniformField, GrowsAsItsGradientSays) {
  UniformField part = uniform({0, 0, 1});
  part.gradient = {g, 2 * g, 3 * g};
  part.offset = {0.01, 0.02};
  const Section section = sections_of(part).at(0);
  const FieldHere<double> middle = field_in(section, {0.01, 0.5, 0.02});
  EXPECT_EQ(middle.field[2], 1e-2);
  EXPECT_NEAR(field_in(section, {0.01, 0.6, 0.02}).field[2], 1e-2 + 0.1 * g, 1e-17);
  EXPECT_NEAR(field_in(section, {0.02, 0.5, 0.02}).field[2], 1e-2 + 0.01 * 2 * g, 1e-17);
  EXPECT_NEAR(field_in(section, {0.01, 0.5, 0.03}).field[2], 1e-2 + 0.01 * 3 * g, 1e-17);
  EXPECT_NEAR(field_in(section, {0.02, 0.5, 0.02}).field[0], -0.01 * 3 * g, 1e-17);
}

TEST(UniformField, WithAGradientHasNeitherDivergenceNorCurlInAnyDirection) {
  for (const UnitVector direction : {UnitVector{0, 0, 1}, UnitVector{1, 0, 0}, UnitVector{0.6, 0, -0.8},
                                     UnitVector{0, 1, 0}, UnitVector{0, -1, 0}})
    for (const Tilt tilt : {Tilt{}, Tilt{0.2, -0.3, 0.4}}) {
      UniformField part = uniform(direction);
      part.tilt = tilt;
      part.gradient = {g, 2 * g, 3 * g};
      const FieldHere<double> f = field_in(sections_of(part).at(0), {0.01, 0.45, -0.03});
      EXPECT_NEAR(f.slope[0] + f.slope[4] + f.slope[8], 0, 1e-17);
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < i; ++k) EXPECT_NEAR(f.slope[3 * i + k], f.slope[3 * k + i], 1e-17);
    }
}

TEST(UniformField, GrowsAlongItsDirectionWhereThatIsTheBeams) {
  for (const double sign : {1.0, -1.0}) {
    UniformField part = uniform({0, sign, 0});
    part.gradient.longitudinal = g;
    const FieldHere<double> f = field_in(sections_of(part).at(0), {0.01, 0.55, 0});
    EXPECT_NEAR(sign * f.field[1], 1e-2 + 0.05 * g, 1e-17);
    EXPECT_NEAR(f.slope[0], -sign * g / 2, 1e-17);
  }
}

TEST(UniformField, TakesItsFringeUpToAHundredMillionthOfTheField) {
  UniformField part = uniform({0, 0, 1});
  part.fringe = TanhFringe{0.01};
  const std::vector<Section> sections = sections_of(part);
  ASSERT_EQ(sections.size(), 1U);
  EXPECT_EQ(sections[0].field, Vector3{});
  EXPECT_NEAR(sections[0].begin, 0.4 - 0.0921034, 2e-4);  // exp(2 s) = 1e8
  EXPECT_LT(field_in(sections[0], {0, sections[0].begin, 0}).field[2], 1e-10);
  EXPECT_NEAR(field_in(sections[0], {0, 0.4, 0}).field[2], 5e-3, 1e-15);
  EXPECT_NEAR(field_in(sections[0], {0, 0.5, 0}).field[2], 1e-2, 1e-10);
}

TEST(UniformField, KeepsTheIntegralOfItsFieldUnderEveryFringe) {
  for (const Fringe& fringe : std::vector<Fringe>{TanhFringe{0.01}, SineFringe{0.05}})
    for (const UnitVector direction : {UnitVector{0, 0, 1}, UnitVector{0.6, 0.8, 0}}) {
      UniformField part = uniform(direction);
      part.fringe = fringe;
      Vector3 sum;
      constexpr int n = 20000;
      for (const Section& section : sections_of(part)) {
        const double step = (section.end - section.begin) / n;
        for (int i = 0; i < n; ++i) {
          const FieldHere<double> f = field_in(section, {0, section.begin + (i + 0.5) * step, 0});
          sum = sum + step * Vector3{f.field[0], f.field[1], f.field[2]};
        }
      }
      EXPECT_LT(length_of(sum - (0.2 * 1e-2) * Vector3{direction}), 2e-5 * 0.2 * 1e-2);
    }
}

TEST(UniformField, RunsAsItsProfileSays) {
  UniformField part = uniform({0, 0, 1});
  part.profile = HalfSineProfile{};
  const Section section = sections_of(part).at(0);
  EXPECT_DOUBLE_EQ(section.begin, 0.4);
  EXPECT_NEAR(field_in(section, {0, 0.5, 0}).field[2], 1e-2, 1e-16);
  EXPECT_NEAR(field_in(section, {0, 0.45, 0}).field[2], 1e-2 * std::sqrt(0.5), 1e-16);
  part.profile = GaussianProfile{0.03};
  EXPECT_NEAR(field_in(sections_of(part).at(0), {0, 0.53, 0}).field[2], 1e-2 * std::exp(-0.5), 1e-16);
  part.fringe = TanhFringe{0.01};
  EXPECT_EQ(faults_of(part, {"B", 0.4, {}}).at(0).key, "profile");
}

TEST(UniformField, RefusesAGradientAskewAndAFringeWithoutEnd) {
  UniformField part = uniform({0, 0, 1});
  EXPECT_TRUE(faults_of(part, {"B", 0.4, {}}).empty());
  part.gradient.transverse = g;
  part.fringe = TanhFringe{0.01};
  EXPECT_TRUE(faults_of(part, {"B", 0.4, {}}).empty());
  part.direction = {0, 0.6, 0.8};
  EXPECT_EQ(faults_of(part, {"B", 0.4, {}}).at(0).key, "gradient");
  part.gradient = {};
  part.fringe = EngeFringe{.length = 0.01, .a1 = -1};
  EXPECT_EQ(faults_of(part, {"B", 0.4, {}}).at(0).key, "fringe");
}

TEST(UniformField, TakesCoefficientsThatAreMissingBesideOthersAsNone) {
  const FringeShape common = shape_of(EngeFringe{.length = 0.01}, RectangularProfile{}),
                    own = shape_of(EngeFringe{.length = 0.01, .a1 = 2}, RectangularProfile{});
  EXPECT_EQ(common.enge[0], 0.478959);
  EXPECT_EQ(common.enge[5], 0.318111);
  EXPECT_EQ(own.enge[1], 2);
  for (const int i : {0, 2, 3, 4, 5}) EXPECT_EQ(own.enge[i], 0);
}

}  // namespace
}  // namespace rabiline::uniform_field_test
