#include "manual/describe.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "input/document.hpp"
#include "scan/experiment.hpp"

namespace rabiline::describe_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// What is suggested for a topic that there is not.
std::string help(const char* topic) {
  try {
    describe(topic);
  } catch (const InputError& e) {
    return e.diagnostics().front().suggestion;
  }
  return std::string{};
}

TEST(Describe, ListsEveryPartAndLaw) {
  const std::string text = describe_overview();
  for (const char* word : {"polarizer", "uniform_field", "rotating_field", "slit", "detector", "monitor",
                           "quantum", "classical", "dorado", "seed"})
    EXPECT_THAT(text, HasSubstr(word));
}

TEST(Describe, TellsUnitRangeDefaultAndMeaningOfEachKey) {
  EXPECT_THAT(describe("rotating_field"), HasSubstr("magnetic field, zero or greater"));
  EXPECT_THAT(describe("dorado"), HasSubstr("default torque"));
  EXPECT_THAT(describe("slit"), HasSubstr("one of: width and height | radius"));
  EXPECT_THAT(describe("solenoid"), HasSubstr("default y"));
  EXPECT_THAT(describe("uniform_field"), HasSubstr("default z"));
  EXPECT_THAT(describe("species"), HasSubstr("Li-7"));
  EXPECT_THAT(describe("units"), HasSubstr("mT, uT"));
}

TEST(Describe, TellsOfAModelWithAllThatItHolds) {
  const std::string page = describe("bound_charge");
  for (const char* text : {"binding, harmonic: ", "orbits per second without the field", "binding, coulomb: ",
                           "charge at the centre", "binding, free: ", "speed at the start"})
    EXPECT_THAT(page, HasSubstr(text));
  EXPECT_THAT(describe("charged_particle"), HasSubstr("one of: speed | lorentz_factor"));
  EXPECT_THAT(describe("charged_particle"), HasSubstr("one of: turns | duration"));
  for (const char* topic : {"harmonic", "coulomb", "free"})
    EXPECT_THAT(describe(topic), HasSubstr(std::string(topic) + " (binding): "));
  EXPECT_THAT(describe("binding"), HasSubstr("in the model `bound_charge`"));
  EXPECT_THAT(describe("torque"), HasSubstr("in the model `rotating_cylinder`"));
}

TEST(Describe, TellsBothMeaningsOfAWordThatHasTwo) {
  EXPECT_THAT(describe("gaussian"), HasSubstr("gaussian (speed)"));
  EXPECT_THAT(describe("gaussian"), HasSubstr("gaussian (direction)"));
}

TEST(Describe, SuggestsTheTopicThatWasMeant) {
  try {
    describe("rotatingfield");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(),
                 "error: there is nothing to describe called `rotatingfield`\n  help: did you mean "
                 "`rotating_field`?\n");
  }
}

TEST(Describe, ListsTheSpeciesWithTheirUncertaintiesUnderEachOther) {
  const std::string text = describe("species");
  EXPECT_THAT(
      text, HasSubstr("  Rb-87     3/2    86.9091805290(60)       0             13.98141(61)      AME2020"));
  EXPECT_THAT(text, HasSubstr("42.577478461(18)  CODATA 2022\n"));
  EXPECT_THAT(text, HasSubstr("\nStone 2014: N. Stone"));
  EXPECT_THAT(describe_overview(), HasSubstr("a species such as Rb-87"));
}

TEST(Describe, TellsWhatFollowsFromTheConstantsOfOneSpecies) {
  const std::string rubidium = describe("Rb-87");
  for (const char* line : {"86.9091805290(60) u = 1.4431609e-25 kg", "3/2, 4 levels", "= 13.98141(61) MHz/T",
                           "= 87.8478(38)e6 rad/s/T", "2.75131(12) nuclear magnetons", "13.98 kHz at 1 mT",
                           "the electrons' moment", "Stone 2014: N. Stone", "species: Rb-87\n"})
    EXPECT_THAT(rubidium, HasSubstr(line));
  EXPECT_THAT(rubidium, testing::Not(HasSubstr("P. Mohr")));
  EXPECT_THAT(describe("proton"), HasSubstr("turns left-handed"));
  EXPECT_THAT(describe("neutron"), HasSubstr("turns right-handed"));
  for (const Species& s : species_library())
    EXPECT_THAT(describe(s.name), testing::StartsWith(s.name + ": a species"));
}

TEST(Describe, SuggestsSpeciesAsWellAsKinds) {
  EXPECT_EQ(help("rb87"), "write `Rb-87`, or with the electron `Rb-87 atom`");
  EXPECT_EQ(help("nuetron"), "did you mean `neutron`?");
  EXPECT_EQ(help("detektor"), "did you mean `detector`?");
  EXPECT_EQ(help("aperture"), "did you mean `slit` or `collimator`?");
  EXPECT_EQ(help("quark"), "`rabiline describe` lists what there is, `rabiline describe species` what flies");
}

TEST(Describe, ListsSpeciesWithLevels) {
  const std::string text = describe("species");
  EXPECT_THAT(text, HasSubstr("  Cs-133 atom   7/2  1/2  16      F=3, F=4 at +9192.63177 MHz"));
  EXPECT_THAT(text, HasSubstr("  Ag-107 atom   1/2  1/2  4       F=1, F=0 at +1712.51211 MHz"));
  EXPECT_THAT(text, HasSubstr("  ortho-H2      1    1    9 "));
  EXPECT_THAT(describe("Cs-133"), HasSubstr("`rabiline describe \"Cs-133 atom\"`"));
  for (const Species& s : species_with_levels())
    EXPECT_THAT(describe(s.name), testing::StartsWith(s.name + ": a species"));
}

TEST(Describe, ShowsTheLevelsOfAnAtom) {
  const std::string caesium = describe("Cs-133 atom");
  // Moments at 0.1 T and fields where they vanish: Breit and Rabi's formula (spin/breit_rabi.hpp).
  for (const char* line :
       {"I = 7/2, J = 1/2: 16 levels", "427.453 Hz/G^2", "gamma/2pi = -28028.04 MHz/T",
        "F=4 m=-1     m_J=+1/2 m_I=-3/2       3883.545563  -0.057151  81.85 mT", "species: Cs-133 atom\n"})
    EXPECT_THAT(caesium, HasSubstr(line));
  EXPECT_THAT(describe("ortho-H2"), HasSubstr("in nuclear magnetons"));
  EXPECT_THAT(describe("ortho-H2"), testing::Not(HasSubstr("clock shift")));
}

TEST(Describe, LeadsFromElementsToSpecies) {
  EXPECT_EQ(help("Cs atom"), "did you mean `Cs-133 atom`?");
  EXPECT_EQ(help("Cs133 atom"), "did you mean `Cs-133 atom`?");
  EXPECT_EQ(help("rubidium"),
            "write which isotope: `Rb-85` or `Rb-87`, or with the electron `Rb-85 atom` or `Rb-87 atom`");
  EXPECT_EQ(help("Rb atom"), "write which isotope: `Rb-85 atom` or `Rb-87 atom`");
  EXPECT_EQ(help("hydrogen"), "write `H`, or with the electron `H atom`");
  EXPECT_EQ(help("H2"), "did you mean `ortho-H2`?");
}

TEST(Describe, TellsWhatIsInANaturalMixture) {
  EXPECT_THAT(describe("natural K atom"), HasSubstr("K-41 atom          6.7310 %"));
  EXPECT_THAT(describe("natural Li"), HasSubstr("Li-6               7.5900 %"));
}

TEST(Describe, ShowsEveryKindOfSpin) {
  EXPECT_THAT(describe("spin"),
              HasSubstr("spin: {kind: levels, levels: [F=4 m=0, F=3 m=0], shares: [0.9, 0.1]}"));
  EXPECT_THAT(describe("spin"), HasSubstr("spin: {kind: thermal, temperature: 400 K}"));
  EXPECT_THAT(describe("structure"), HasSubstr("A I.J"));
}

/// The lines after "Example", without their indentation.
std::string snippet_of(std::string_view topic) {
  const std::string text = describe(topic);
  const std::size_t from = text.rfind("Example\n  ");
  return from == std::string::npos ? "" : text.substr(from + 10);
}

TEST(Describe, GivesSnippetsOfPartsThatRunAsTheyStand) {
  const auto path = std::filesystem::temp_directory_path() / "rabiline_describe_test.yaml";
  for (const char* kind : {"polarizer", "uniform_field", "rotating_field", "slit", "detector", "monitor",
                           "two_wire_magnet", "iron_magnet", "multipole_magnet"}) {
    std::ofstream(path)
        << "rabiline: 1\nspecies: neutron\nparticles: 1\nseed: 1\n"
        << snippet_of("law").substr(0, 12) << "\nsource:\n  " << snippet_of("speed") << "  "
        << snippet_of("opening") << "  " << snippet_of("cone") << "parts:\n  " << snippet_of(kind)
        << "  - {name: screen, kind: detector, at: 3 m, width: 1 mm, height: 1 mm, bins: [1, 1]}\n";
    try {
      EXPECT_EQ(load_experiment(load_file(path), {}).base.parts.size(), 2U);
    } catch (const InputError& e) {
      ADD_FAILURE() << kind << "\n" << e.what();
    }
  }
  std::filesystem::remove(path);
}

TEST(Describe, TellsHowTalliesAreWrittenAndWhatTheyCount) {
  EXPECT_THAT(describe("monitor"), HasSubstr("list of {name, axes}"));
  EXPECT_THAT(describe("detector"), HasSubstr("{width and height | radius, offset}"));
  for (const char* word :
       {"time_of_flight", "prepared_level", "state-to-state matrix", "outside", "expectation"})
    EXPECT_THAT(describe("tallies"), HasSubstr(word));
}

TEST(Describe, TellsWhatStandsAtThePlaceOfAPart) {
  EXPECT_THAT(describe("uniform_field"), HasSubstr("where the part begins"));
  EXPECT_THAT(describe("field_map"),
              HasSubstr("where the origin of the map (x, y, z = 0 of its table) stands"));
  EXPECT_THAT(describe("solenoid"), HasSubstr("the middle of the cylinder"));
  EXPECT_THAT(describe("detector"), AllOf(HasSubstr("where the screen is"), Not(HasSubstr("the hole"))));
}

TEST(JsonSchema, HasEveryKeyOfABeamline) {
  const std::string text = json_schema();
  const Node root = parse_document(make_source_text("schema", text), text);
  const Node& beamline = root.find("anyOf")->value.items.at(0);
  const Node& properties = beamline.find("properties")->value;
  for (const char* key :
       {"rabiline", "title", "species", "law", "source", "chamber", "parts", "particles", "seed", "scan"})
    EXPECT_TRUE(properties.find(key)) << key;
  EXPECT_THAT(to_text(beamline.find("required")->value), AllOf(HasSubstr("law"), Not(HasSubstr("parts"))));
  EXPECT_THAT(text, HasSubstr("rotating_field"));
  EXPECT_THAT(text, HasSubstr("prepared_level"));
}

TEST(JsonSchema, HasAGeometryThatSaysNothingOfWhatFlies) {
  const std::string text = json_schema();
  const Node root = parse_document(make_source_text("schema", text), text);
  const Node& geometry = root.find("anyOf")->value.items.at(1);
  const Node& properties = geometry.find("properties")->value;
  for (const char* key : {"rabiline", "title", "chamber", "parts"}) EXPECT_TRUE(properties.find(key)) << key;
  EXPECT_FALSE(properties.find("species"));
  EXPECT_EQ(to_text(geometry.find("required")->value), R"([rabiline, parts])");
}

}  // namespace
}  // namespace rabiline::describe_test
