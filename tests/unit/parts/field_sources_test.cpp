// Parts whose fields differ from place to place, put on the beam.
#include <gtest/gtest.h>

#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "parts/part.hpp"
#include "section/section_builder.hpp"

namespace rabiline::field_sources_test {
namespace {

constexpr double mu_0 = 1.25663706127e-6;

template <class P>
Section section_of(const P& part, double at = 3) {
  SectionBuilder builder(Wall{});
  contribute(part, {"C", at, {}}, builder);
  return builder.build().sections.at(0);
}
Vector3 field_in(const Section& section, const Vector3& r) {
  FieldHere<double> sum{{section.field.x, section.field.y, section.field.z}, {}};
  for (const ShapedTerm& term : section.shaped) add_field<HostMaths>(term, r.x, r.y, r.z, sum);
  return {sum.field[0], sum.field[1], sum.field[2]};
}

TEST(CurrentLoopPart, StandsAroundItsPlaceAndReachesToATenThousandth) {
  CurrentLoop part{0.05, CoilCurrent{2, 100}};
  part.offset = {0.01, -0.02};
  const Section section = section_of(part);
  EXPECT_NEAR(field_in(section, {0.01, 3, -0.02}).y, mu_0 * 200 / 0.1, 1e-15);
  EXPECT_NEAR(field_in(section, {0.01, section.end, -0.02}).y / field_in(section, {0.01, 3, -0.02}).y, 1e-4,
              1e-8);
  EXPECT_DOUBLE_EQ(section.end - 3, 3 - section.begin);
  part.reach = 0.25;
  EXPECT_DOUBLE_EQ(section_of(part).begin, 2.75);
}

TEST(CurrentLoopPart, PointsWhereItsDirectionAndItsTiltSay) {
  CurrentLoop part{0.05, CoilField{1e-3}};
  part.direction = {0, 0, 1};
  part.tilt.x = 0.1;
  const Vector3 field = field_in(section_of(part), {0, 3, 0});
  EXPECT_NEAR(field.z, 1e-3 * std::cos(0.1), 1e-15);
  EXPECT_NEAR(field.y, -1e-3 * std::sin(0.1), 1e-15);
}

TEST(SolenoidPart, HasTheFieldOfItsCurrentOrThatStatedInItsMiddle) {
  const Solenoid wound{0.4, 0.05, CoilCurrent{2, 300}};
  const double expected = mu_0 * 600 / std::hypot(0.4, 0.1);  // mu_0 N I/sqrt(L^2 + 4 R^2)
  EXPECT_NEAR(field_in(section_of(wound), {0, 3, 0}).y, expected, 1e-12 * expected);
  const Solenoid stated{0.4, 0.05, CoilField{expected}};
  EXPECT_NEAR(field_in(section_of(stated), {0.01, 3.1, 0.02}).y,
              field_in(section_of(wound), {0.01, 3.1, 0.02}).y, 1e-15);
  const Section section = section_of(wound, 10);
  EXPECT_NEAR(field_in(section, {0, section.begin, 0}).y / expected, 1e-4, 1e-7);
}

TEST(CoilPairPart, OfHelmholtzIsEvenToTheFourthOrder) {
  const CoilPair part{0.1, {}, CoilField{1e-3}};
  const Section section = section_of(part);
  EXPECT_NEAR(field_in(section, {0, 3, 0}).z, 1e-3, 1e-17);
  const double near = 1e-3 - field_in(section, {0, 3, 0.005}).z,
               far = 1e-3 - field_in(section, {0, 3, 0.01}).z;
  EXPECT_NEAR(far / near, 16, 0.2);
  EXPECT_NEAR(field_in(section_of(CoilPair{0.1, {}, CoilCurrent{1, 1}}), {0, 3, 0}).z,
              mu_0 * std::pow(0.8, 1.5) / 0.1, 1e-17);
}

TEST(CoilPairPart, OfOpposedCurrentsHasItsGradientInTheMiddle) {
  const Section section = section_of(CoilPair{0.1, 0.15, CoilGradient{0.2}});
  EXPECT_NEAR(field_in(section, {0, 3, 0}).z, 0, 1e-17);
  EXPECT_NEAR(field_in(section, {0, 3, 1e-4}).z, 0.2 * 1e-4, 1e-10);
  EXPECT_NEAR(field_in(section, {1e-4, 3, 0}).x, -0.1 * 1e-4, 1e-10);
  CoilPair wound{0.1, 0.15, CoilCurrent{1, 1}};
  wound.opposed = true;
  EXPECT_NEAR(field_in(section_of(wound), {0, 3, 0}).z, 0, 1e-20);
  EXPECT_GT(field_in(section_of(wound), {0, 3, 0.05}).z, 0);
  CoilPair wrong{0.1, 0.15, CoilField{1e-3}};
  wrong.opposed = true;
  EXPECT_EQ(faults_of(wrong, {"C", 3, {}}).size(), 1U);
}

TEST(StraightWirePart, CrossesTheBeamAtItsOffset) {
  StraightWire part{10, 0.1, 1e-4};
  part.offset.z = -0.002;
  const Section section = section_of(part);
  EXPECT_DOUBLE_EQ(section.begin, 2.9);
  // x times z is -y: 10 A, 2 mm below the beam.
  EXPECT_NEAR(field_in(section, {0.3, 3, 0}).y, -1e-3, 1e-12);
}

TEST(CurrentSheetPart, StandsAcrossTheBeamWithItsCurrentAlongX) {
  CurrentSheet part{100, 0.1, 0.2};
  const double half = mu_0 * 100 / 0.1 / 2;  // mu_0 K/2
  EXPECT_DOUBLE_EQ(section_of(part).begin, 2.8);
  EXPECT_NEAR(field_in(section_of(part), {0, 3 - 1e-6, 0}).z, -half, 1e-4 * half);
  EXPECT_NEAR(field_in(section_of(part), {0, 3 + 1e-6, 0}).z, half, 1e-4 * half);
  EXPECT_NEAR(field_in(section_of(part), {0, 3 + 0.05, 0}).z, half / 2, 1e-12);  // seen under 90 degrees
  part.tilt.x = std::numbers::pi / 2;  // below and above the beam: y of its own frame is z
  EXPECT_NEAR(field_in(section_of(part), {0, 3, 1e-6}).y, -half, 1e-4 * half);
}

TEST(MultipoleFieldPart, MayBeTurnedAboutTheBeam) {
  MultipoleField part{0.2, 4, 1e-3, 0.01};
  EXPECT_NEAR(field_in(section_of(part), {0, 3.1, 0.01}).z, 1e-3, 1e-17);
  part.tilt.y = 0.3;  // from +z towards +x
  const Vector3 field = field_in(section_of(part), {0.01 * std::sin(0.3), 3.1, 0.01 * std::cos(0.3)});
  EXPECT_NEAR(field.x, 1e-3 * std::sin(0.3), 1e-16);
  EXPECT_NEAR(field.z, 1e-3 * std::cos(0.3), 1e-16);
  EXPECT_EQ(faults_of(MultipoleField{0.2, 5, 1e-3, 0.01}, {"Q", 3, {}}).size(), 1U);
}

TEST(GradientMagnetPart, HasOnTheAxisTheFieldOfThePlaceThatIsMovedThere) {
  GradientMagnet part;
  part.length = 0.1;
  part.field = 1;
  part.gradient = 100;
  part.along = {0.6, 0, 0.8};
  part.offset = {0.4e-3, -0.7e-3};
  const double expected = 1 - 100 * (0.6 * 0.4e-3 - 0.8 * 0.7e-3);
  EXPECT_NEAR(static_field(part).field.z, expected, 1e-15);
  EXPECT_NEAR(section_of(part).field.z, expected, 1e-15);
}

}  // namespace
}  // namespace rabiline::field_sources_test
