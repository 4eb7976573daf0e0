// Every broken file of tests/corpus/broken has its whole message beside it. After a change of wording:
// tests/corpus/update.sh, then read the difference.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "scan/model_file.hpp"

namespace rabiline::corpus_test {
namespace {

namespace fs = std::filesystem;
const fs::path corpus = fs::path(RABILINE_ROOT) / "tests/corpus";

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream out;
  out << file.rdbuf();
  return out.str();
}

/// NAME.args has one word of the command line in each line.
Changes arguments_beside(fs::path yaml) {
  Changes out;
  std::ifstream file(yaml.replace_extension(".args"));
  for (std::string option, value; std::getline(file, option) && std::getline(file, value);) {
    if (option == "--set")
      out.set.push_back(value);
    else if (option == "--scan")
      out.scan.push_back(value);
    else if (option == "--particles")
      out.particles = value;
    else
      ADD_FAILURE() << yaml << ": unknown option " << option;
  }
  return out;
}

std::vector<std::string> files_in(const char* folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(corpus / folder))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

class BrokenFile : public testing::TestWithParam<std::string> {
 protected:
  BrokenFile() { fs::current_path(corpus / "broken"); }
};

TEST_P(BrokenFile, IsExplainedWordForWord) {
  const fs::path yaml = GetParam() + ".yaml";
  const fs::path expected = GetParam() + ".expected";
  std::string message;
  try {
    load_any(load_file(yaml), arguments_beside(yaml));
  } catch (const InputError& e) {
    message = e.what();
  }
  EXPECT_NE(message, "") << "the file was read without an error";
  if (std::getenv("RABILINE_UPDATE_CORPUS")) std::ofstream(expected, std::ios::binary) << message;
  EXPECT_EQ(message, contents(expected));
}
INSTANTIATE_TEST_SUITE_P(Corpus, BrokenFile, testing::ValuesIn(files_in("broken")),
                         [](const auto& test) { return test.param; });

class GoodFile : public testing::TestWithParam<std::string> {
 protected:
  GoodFile() { fs::current_path(corpus / "good"); }
};

TEST_P(GoodFile, IsRead) {
  const fs::path yaml = GetParam() + ".yaml";
  EXPECT_NO_THROW(load_any(load_file(yaml), arguments_beside(yaml)));
}
INSTANTIATE_TEST_SUITE_P(Corpus, GoodFile, testing::ValuesIn(files_in("good")),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace rabiline::corpus_test
