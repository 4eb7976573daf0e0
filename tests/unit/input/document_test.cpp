#include "input/document.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "input/file.hpp"
#include "storage/storage_error.hpp"

namespace rabiline::document_test {
namespace {

using testing::HasSubstr;

Node parse(const std::string& text) { return parse_document(make_source_text("t.yaml", text), text); }

std::string error_of(const std::string& text) {
  try {
    parse(text);
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

TEST(Document, KnowsWhereEverythingStands) {
  const Node root = parse("a: 1\nsource:\n  speed: {kind: single}\nlist: [x, \"y z\"]\n");
  const Entry& source = *root.find("source");
  EXPECT_EQ(source.key_place.line, 2);
  EXPECT_EQ(source.key_place.length, 6);
  const Node& kind = source.value.find("speed")->value.find("kind")->value;
  EXPECT_EQ(kind.place.line, 3);
  EXPECT_EQ(kind.place.column, 17);
  EXPECT_EQ(kind.place.length, 6);
  const Node& quoted = root.find("list")->value.items[1];
  EXPECT_TRUE(quoted.quoted);
  EXPECT_EQ(quoted.scalar, "y z");
  EXPECT_EQ(quoted.place.length, 5);
}

TEST(Document, KeepsWordsAsTheyStand) {
  const Node root = parse("[yes, 010, 1e6, .inf, ~, '', null, \"~\"]");
  EXPECT_EQ(root.items[0].scalar, "yes");
  EXPECT_EQ(root.items[1].scalar, "010");
  EXPECT_EQ(root.items[3].scalar, ".inf");
  EXPECT_TRUE(root.items[4].is_null());
  EXPECT_TRUE(root.items[5].is_scalar());
  EXPECT_TRUE(root.items[6].is_null());
  EXPECT_EQ(root.items[7].scalar, "~");
}

TEST(Document, FollowsAnAlias) {
  const Node root = parse("a: &size {x: 1 mm}\nb: *size\n");
  EXPECT_EQ(root.find("b")->value.find("x")->value.scalar, "1 mm");
}

TEST(Document, CountsColumnsInBytesAndLengthsInCharacters) {
  const Node root = parse("{\u00b5: \u00b5\u00b5, b: 1}");
  EXPECT_EQ(root.entries[0].value.place.column, 6);
  EXPECT_EQ(root.entries[0].value.place.length, 2);
}

TEST(Document, RefusesAFileThatIsLargerThanAnyExperiment) {
  EXPECT_THAT(error_of(std::string(max_text_bytes + 1, '#')), HasSubstr("larger than 1048576 bytes"));
  std::string many = "[";
  for (std::size_t i = 0; i < max_nodes; ++i) many += "1,";
  EXPECT_THAT(error_of(many + "]"), HasSubstr("more than 100000 values"));
}

TEST(Document, ReadsAValueInsideAnArgumentWithPlacesOfTheArgument) {
  const auto argument = make_source_text("--set", "law={name: dorado}");
  const Node value = parse_value(argument, 4, 14);
  EXPECT_EQ(value.find("name")->value.place.column, 12);
  EXPECT_EQ(to_text(value), "{name: dorado}");
}

TEST(File, ThatIsNotThereOrAFolderCannotBeRead) {
  try {
    load_file("no/such/file.yaml");
    FAIL();
  } catch (const StorageError& e) {
    EXPECT_STREQ(e.what(), "no/such/file.yaml: there is no such file");
  }
  try {
    load_file(".");
    FAIL();
  } catch (const StorageError& e) {
    EXPECT_STREQ(e.what(), ".: this is a folder, not a file\n  help: name the file in it");
  }
}

TEST(File, PutsThePartsOfItsGeometryBeforeItsOwn) {
  const auto folder = std::filesystem::temp_directory_path() / "rabiline_geometry_test";
  std::filesystem::create_directories(folder / "shared");
  std::ofstream(folder / "shared/bench.yaml") << "rabiline: 1\nchamber: {radius: 1 m}\nparts: [{name: A}]\n";
  std::ofstream(folder / "main.yaml") << "geometry: shared/bench.yaml\nparts: [{name: B}]\n";
  const LoadedFile file = load_file(folder / "main.yaml");
  const std::vector<Node>& parts = file.root.find("parts")->value.items;
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].find("name")->value.scalar, "A");
  EXPECT_EQ(parts[0].place.text->name, (folder / "shared/bench.yaml").string());
  EXPECT_TRUE(file.root.find("chamber"));
  ASSERT_EQ(file.inputs.size(), 2U);
  EXPECT_EQ(file.inputs[0].path, (folder / "main.yaml").string());
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace rabiline::document_test
