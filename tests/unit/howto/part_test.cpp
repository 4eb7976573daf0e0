// The part that docs/architecture.md adds, compiled as it stands there and put through what parts go through.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "constants.hpp"
#include "manual/describe_page.hpp"
#include "manual/schema_page.hpp"
#include "parts/long_solenoid.hpp"
#include "scan/member.hpp"
#include "section/section_builder.hpp"

namespace rabiline::part_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using OnePart = std::variant<LongSolenoid>;  // what `Part` is with a line more

constexpr const char* text =
    "{name: S, kind: long_solenoid, at: 0.2 m, length: 50 cm, radius: 2 cm, turns: 400, current: 25 mA}";

struct Read {
  Placement placement;
  OnePart part;
  Reading reading;
};
Read read(const std::string& yaml) {
  Read out;
  const Node node = parse_document(make_source_text("t.yaml", yaml), yaml);
  Keys keys(node, "the part `S`", node.place, out.reading);
  bool kind_known = false;
  read_tagged(keys, {"S", Dimension::number, range::any, "what the part is"}, out.part, kind_known);
  read_rows(keys, out.placement);
  keys.finish();
  return out;
}
LongSolenoid solenoid() { return std::get<LongSolenoid>(read(text).part); }

TEST(PartOfTheHowTo, IsReadByItsTable) {
  const Read found = read(text);
  EXPECT_TRUE(found.reading.errors.empty()) << render(found.reading.errors);
  EXPECT_EQ(found.placement.name, "S");
  EXPECT_EQ(found.placement.at, 0.2);
  EXPECT_EQ(std::get<LongSolenoid>(found.part), (LongSolenoid{0.5, 0.02, 400, 0.025}));
}

TEST(PartOfTheHowTo, HasMessagesForEachMistake) {
  const std::string message = render(
      read("{name: S, kind: long_solenoid, at: 0.2 m, length: 0 m, radius: 2 T, turn: 400, current: 25 mA}")
          .reading.errors);
  EXPECT_THAT(message, HasSubstr("`length` must be greater than zero"));
  EXPECT_THAT(message, HasSubstr("`radius` is a length"));
  EXPECT_THAT(message, HasSubstr("turns"));
}

TEST(PartOfTheHowTo, IsSetAndScannedByItsName) {
  LongSolenoid part = solenoid();
  Reading reading;
  const std::string value = "50 mA";
  const Node node = parse_document(make_source_text("--set", value), value);
  const std::vector<std::string> path{"current"};
  auto set = [&](const auto& row, auto& member) {
    read_value(node, node.place, row_of(row), reading, member);
  };
  EXPECT_TRUE(visit_member(part, path, set));
  EXPECT_EQ(part.current, 0.05);
}

TEST(PartOfTheHowTo, IsDescribedAndInTheSchema) {
  const std::string page = describe_part<LongSolenoid>();
  EXPECT_THAT(page, HasSubstr("solenoid: a field along the beam"));
  EXPECT_THAT(page, HasSubstr("in each turn, right-handed about +y"));
  EXPECT_THAT(page, HasSubstr("kind: long_solenoid, at: 0.25 m, length: "));
  const std::vector<std::string> schemas = schemas_of_part<LongSolenoid>();
  ASSERT_EQ(schemas.size(), 1U);
  EXPECT_THAT(schemas[0], HasSubstr(R"("const": "long_solenoid")"));
  EXPECT_THAT(schemas[0],
              HasSubstr(R"("required": ["kind", "name", "at", "length", "radius", "turns", "current"])"));
}

TEST(PartOfTheHowTo, HasARule) {
  EXPECT_TRUE(faults_of(LongSolenoid{0.2, 0.02, 400, 0.025}, {"S", 0.2, {}}).empty());
  const std::vector<Fault> faults = faults_of(LongSolenoid{0.199, 0.02, 400, 0.025}, {"S", 0.2, {}});
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(dotted_name(faults[0].subject, faults[0].key), "S.length");
  EXPECT_THAT(faults[0].message, HasSubstr("too short"));
}

TEST(PartOfTheHowTo, ContributesItsFieldAndItsWall) {
  SectionBuilder builder(Wall{0.05, chamber_number});
  builder.begin_part(7);
  contribute(solenoid(), {"S", 0.2, {}}, builder);
  const Sections sections = builder.build();
  ASSERT_EQ(sections.sections.size(), 1U);
  const Section& inside = sections.sections[0];
  EXPECT_EQ(inside.begin, 0.2);
  EXPECT_EQ(inside.end, 0.7);
  // mu_0 = 4 pi 1e-7 T m/A to a part in 10^9; 800 turns in a metre
  EXPECT_NEAR(inside.field.y, 4e-7 * test::pi * 800 * 0.025, 1e-12);
  EXPECT_THAT((std::array{inside.field.x, inside.field.z}), ElementsAre(0, 0));
  EXPECT_EQ(inside.wall, (Wall{0.02, 7, {}}));
}

}  // namespace
}  // namespace rabiline::part_test
