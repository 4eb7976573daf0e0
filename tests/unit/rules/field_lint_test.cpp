#include "rules/field_lint.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "physics/suggested.hpp"

namespace rabiline::field_lint_test {
namespace {

using test::place;
using test::suggested;
using testing::HasSubstr;

Beamline with(const Part& part) {
  Beamline beamline = suggested(291.6e3);
  beamline.parts.push_back(place("F", 0.6, part));
  return beamline;
}

/// B_z = 1 mT (1 + (x/1 cm)^3) with what makes it one without divergence and curl, or not.
LoadedMap map_of(double wrong) {
  MapNodes nodes;
  for (int a = 0; a < 3; ++a) nodes.axes.push_back({9, -0.004, 0.001});
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j)
      for (int k = 0; k < 9; ++k) {
        const double x = -0.4 + 0.1 * i, z = -0.4 + 0.1 * k;  // [cm]; B_z - i B_x = 1 + (z + i x)^3
        nodes.field.insert(nodes.field.end(), {1e-3 * (x * x * x - 3 * z * z * x) * (1 - wrong), 0,
                                               1e-3 * (1 + z * z * z - 3 * z * x * x)});
      }
  return {std::make_shared<const FieldMap>(std::move(nodes), std::array<MapSymmetry, 3>{}, "m.csv")};
}

TEST(FieldLint, SaysNothingOfUniformFields) {
  EXPECT_EQ(report_of_fields(suggested(291.6e3)), "");
  EXPECT_TRUE(warnings_of_fields(suggested(291.6e3)).empty());
}

TEST(FieldLint, SaysWhereTheStaticFieldTurnsAtOnce) {
  UniformField across;
  across.length = 0.05;
  across.field = 1e-3;
  across.direction = {1, 0, 0};
  Beamline beamline = suggested(291.6e3);
  beamline.parts = {place("A", 0.6, across)};
  EXPECT_EQ(report_of_fields(beamline), "");
  across.direction = {0, 0, 1};
  beamline.parts.push_back(place("B", 0.65, across));
  across.direction = {0, 0, -1};
  beamline.parts.push_back(place("C", 0.8, across));
  EXPECT_EQ(report_of_fields(beamline),
            "where the static field on the axis changes direction abruptly\n  by 90 degrees at 650 mm\n"
            "  by 180 degrees over the gap from 700 mm to 800 mm\n");
}

TEST(FieldLint, SaysWhereAFieldEndsAndHowLargeItStillIs) {
  CurrentLoop loop{0.01, CoilField{1e-3}};
  EXPECT_THAT(report_of_fields(with(loop)),
              HasSubstr("F: current_loop, 384.8 mm to 815.2 mm, up to 1 mT on the axis, 100 nT"));
  EXPECT_TRUE(warnings_of_fields(with(loop)).empty());
  loop.reach = 0.05;
  const std::vector<Fault> found = warnings_of_fields(with(loop));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found[0].message, HasSubstr("abruptly, at 0.754 % of its largest"));
  EXPECT_THAT(found[0].help, HasSubstr("`reach`"));
}

TEST(FieldLint, KnowsTheSizeOfAFieldThatTurns) {
  RotatingField drive;
  drive.length = 0.05;
  drive.amplitude = 85e-6;
  drive.frequency = 29e3;
  drive.sense = Sense::co;
  drive.fringe = TanhFringe{0.005};
  EXPECT_THAT(report_of_fields(with(drive)),
              HasSubstr("F: rotating_field, 553.9 mm to 696.1 mm, up to 84.99 uT"));
}

TEST(FieldLint, KnowsThatAFieldFollowsTheClockOfAnother) {
  CurrentLoop loop{0.01, CoilField{1e-3}};
  loop.reach = 0.05;
  Beamline beamline = with(loop);
  RotatingField follower;
  follower.length = 0.05;
  follower.amplitude = 1e-6;
  follower.oscillator = "H0";
  beamline.parts.push_back(place("H1", 0.58, follower));
  EXPECT_EQ(warnings_of_fields(beamline).size(), 1U);
}

TEST(FieldLint, DoesNotMindEdgesThatAreHardByNature) {
  EXPECT_TRUE(warnings_of_fields(with(MultipoleField{0.1, 4, 1e-3, 0.01})).empty());
}

TEST(FieldLint, TellsAMapThatIsNoFieldFromOneThatIs) {
  MappedField right{map_of(0)}, wrong{map_of(2)};
  EXPECT_THAT(report_of_fields(with(right)), HasSubstr("m.csv: 9 x 9 x 9 nodes"));
  const auto blames_components = [](const std::vector<Fault>& faults) {
    return std::any_of(faults.begin(), faults.end(), [](const Fault& fault) { return fault.key == "map"; });
  };
  EXPECT_FALSE(blames_components(warnings_of_fields(with(right))));
  EXPECT_TRUE(blames_components(warnings_of_fields(with(wrong))));
  EXPECT_TRUE(blames_components(warnings_of_fields(with(MappedField{map_of(0.03)}))));
}

}  // namespace
}  // namespace rabiline::field_lint_test
