#include "section/section_builder.hpp"

#include <gtest/gtest.h>

#include "parts/part.hpp"

namespace rabiline::section_builder_test {
namespace {

constexpr Wall chamber{0.05, chamber_number};

RotatingField h0(double length, std::optional<std::string> oscillator = {}) {
  RotatingField part;
  part.length = length;
  part.amplitude = 1e-6;
  part.oscillator = std::move(oscillator);
  if (!part.oscillator) {
    part.frequency = 1e5;
    part.sense = Sense::counter;
    part.phase = {Phase::Kind::random, 0};
  }
  return part;
}

TEST(SectionBuilder, CutsAtEveryEdgeAndAddsUpFieldsThatOverlap) {
  SectionBuilder builder(chamber);
  contribute(UniformField{0.3, 1e-3, {}}, {"A", 0.1, {}}, builder);
  contribute(UniformField{0.4, 2e-3, {}}, {"B", 0.3, {}}, builder);
  const Sections s = builder.build();
  ASSERT_EQ(s.sections.size(), 3U);
  EXPECT_EQ(s.sections[0].field.z, 1e-3);
  EXPECT_DOUBLE_EQ(s.sections[1].field.z, 3e-3);
  EXPECT_EQ(s.sections[2].field.z, 2e-3);
  EXPECT_EQ(s.sections[1].begin, 0.3);
  EXPECT_EQ(s.sections[1].end, 0.4);
}

TEST(SectionBuilder, LeavesNoSectionWhereNothingStands) {
  SectionBuilder builder(chamber);
  contribute(UniformField{0.1, 1e-3, {}}, {"A", 0.1, {}}, builder);
  contribute(UniformField{0.1, 2e-3, {}}, {"B", 0.5, {}}, builder);
  EXPECT_EQ(builder.build().sections.size(), 2U);
}

TEST(SectionBuilder, TakesPlacesThatDecimalNumbersMeanToBeOneAsOne) {
  // 0.2 + 0.01 ends one bit after 0.21: no section of 3e-17 m with both fields.
  SectionBuilder builder(chamber);
  ASSERT_GT(0.2 + 0.01, 0.21);
  contribute(UniformField{0.01, 1e-3, {}}, {"A", 0.2, {}}, builder);
  contribute(UniformField{0.1, 2e-3, {}}, {"B", 0.21, {}}, builder);
  contribute(Slit{Disc{1e-3}, {}}, {"S", 0.2 + 0.01, {}}, builder);
  const Sections s = builder.build();
  ASSERT_EQ(s.sections.size(), 2U);
  EXPECT_EQ(s.sections[0].end, s.sections[1].begin);
  EXPECT_EQ(s.sections[0].field.z, 1e-3);
  EXPECT_EQ(s.sections[1].field.z, 2e-3);
  EXPECT_EQ(s.planes[0].y, s.sections[1].begin);
}

TEST(SectionBuilder, TakesTheNarrowestWallAndKnowsWhoseItIs) {
  SectionBuilder builder(chamber);
  builder.begin_part(0);
  contribute(UniformField{0.4, 1e-3, Bore{0.02}}, {"A", 0.1, {}}, builder);
  builder.begin_part(1);
  contribute(UniformField{0.2, 1e-3, Bore{0.01}}, {"B", 0.2, {}}, builder);
  const Sections s = builder.build();
  ASSERT_EQ(s.sections.size(), 3U);
  EXPECT_EQ(s.sections[0].wall, (Wall{0.02, 0}));
  EXPECT_EQ(s.sections[1].wall, (Wall{0.01, 1}));
  SectionBuilder narrow({0.005, chamber_number});
  contribute(UniformField{0.2, 1e-3, Bore{0.01}}, {"B", 0.2, {}}, narrow);
  EXPECT_EQ(narrow.build().sections[0].wall.part, chamber_number);
}

TEST(SectionBuilder, LetsAZoneFollowTheClockOfItsOscillatorAndAddsItsOwnPhase) {
  SectionBuilder builder(chamber);
  builder.begin_part(0);
  RotatingField second = h0(0.1, "first");
  second.phase = {Phase::Kind::angle, 0.7};
  contribute(second, {"second", 0.5, {}}, builder);  // stands before its oscillator in the list
  builder.begin_part(1);
  contribute(h0(0.1), {"first", 0.1, {}}, builder);
  const Sections s = builder.build();
  ASSERT_EQ(s.sections.size(), 2U);
  const Oscillator& a = s.sections[0].rotating.at(0).oscillator;
  const Oscillator& b = s.sections[1].rotating.at(0).oscillator;
  EXPECT_EQ(a.part, 1);
  EXPECT_EQ(b.part, 1);
  EXPECT_TRUE(b.random_phase);
  EXPECT_EQ(b.frequency, 1e5);
  EXPECT_EQ(b.turn, Turn::against_precession);
  EXPECT_EQ(b.phase - a.phase, 0.7);
}

TEST(Oscillator, TurnsWithThePrecessionOfEitherSignOfGamma) {
  Oscillator oscillator;
  oscillator.frequency = 1;
  oscillator.turn = Turn::with_precession;
  EXPECT_GT(oscillator.omega(-1e8), 0);  // dS/dt = gamma S x B: S turns with -gamma B
  EXPECT_LT(oscillator.omega(1e8), 0);
  oscillator.turn = Turn::against_precession;
  EXPECT_LT(oscillator.omega(-1e8), 0);
  oscillator.turn = Turn::negative;
  EXPECT_LT(oscillator.omega(-1e8), 0);
}

GradientMagnet magnet_of(double length) {
  GradientMagnet magnet;
  magnet.length = length;
  magnet.field = 0.5;
  magnet.gradient = 100;
  magnet.gap = Rectangle{0.004, 0.001};
  return magnet;
}

TEST(SectionBuilder, KeepsAMagnetAPlaneWhereOtherFieldsOnlyTouchIt) {
  SectionBuilder builder(chamber);
  contribute(magnet_of(0.1), {"M", 0.1, {}}, builder);
  builder.begin_part(1);
  contribute(UniformField{0.1, 1e-3, {}}, {"A", 0.0, {}}, builder);
  contribute(UniformField{0.1, 0.0, {}}, {"none", 0.15, {}}, builder);
  const Sections s = builder.build();
  ASSERT_EQ(s.planes.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<MagnetTerm>(s.planes[0].term));
  for (const Section& section : s.sections) EXPECT_FALSE(section.has_shaped_fields());
}

TEST(SectionBuilder, MakesAMagnetThatAnotherFieldOverlapsOneFieldAmongOthersWithItsGap) {
  SectionBuilder builder(chamber);
  contribute(magnet_of(0.1), {"M", 0.1, {}}, builder);
  builder.begin_part(1);
  contribute(UniformField{0.1, 1e-3, {}}, {"A", 0.15, {}}, builder);
  const Sections s = builder.build();
  EXPECT_TRUE(s.planes.empty());
  ASSERT_EQ(s.sections.size(), 3U);
  for (const int i : {0, 1}) {
    const Section& section = s.sections[static_cast<std::size_t>(i)];
    ASSERT_EQ(section.shaped.size(), 1U);
    EXPECT_EQ(section.shaped[0].part, 0);
    ASSERT_EQ(section.gaps.size(), 1U);
    EXPECT_EQ(section.gaps[0].walls.half_z, 0.0005);
    EXPECT_EQ(section.field.z, i == 0 ? 0 : 1e-3);
  }
  EXPECT_FALSE(s.sections[2].has_shaped_fields());
  const Sections fields = builder.build(Magnets::uniform);
  EXPECT_TRUE(fields.planes.empty());
  EXPECT_EQ(fields.sections[0].field.z, 0.5);
}

TEST(SectionBuilder, TakesTheFieldOfAMovedMagnetOnTheAxis) {
  GradientMagnet magnet = magnet_of(0.1);
  magnet.along = {0.6, 0, 0.8};
  magnet.offset = {0.001, 0.002};
  SectionBuilder builder(chamber);
  contribute(magnet, {"M", 0.1, {}}, builder);
  const Sections fields = builder.build(Magnets::uniform);
  EXPECT_NEAR(fields.sections[0].field.z, 0.5 - 100 * (0.6 * 0.001 + 0.8 * 0.002), 1e-15);
  EXPECT_EQ(static_field(magnet).field.z, fields.sections[0].field.z);
}

}  // namespace
}  // namespace rabiline::section_builder_test
