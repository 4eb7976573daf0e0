// Damaged files are read or explained, and never crash or hang; most telling under the sanitizers.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "scan/experiment.hpp"

namespace rabiline::mutation_test {
namespace {

constexpr const char* fragments[] = {"{",  "}",   "[",     "]",    ":",  ",",   "- ", "\n",
                                     "\"", "&a ", "*a",    "~",    "|",  "#",   "? ", "1e999",
                                     "-1", "\t",  "---\n", "\xff", "{}", "law", ".",  "@"};

/// Cuts, overwrites, drops, repeats or inserts something at a random place.
std::string damaged(std::string text, std::mt19937& random) {
  const std::size_t at = random() % text.size();
  switch (random() % 5) {
    case 0:
      return text.substr(0, at);
    case 1:
      text[at] = static_cast<char>(random() % 256);
      return text;
    case 2:
      return text.erase(at, 1 + random() % 20);
    case 3:
      return text.insert(at, text.substr(random() % text.size(), random() % 60));
    default:
      return text.insert(at, fragments[random() % std::size(fragments)]);
  }
}

TEST(DamagedFile, IsReadOrExplained) {
  std::ifstream file(std::filesystem::path(RABILINE_ROOT) / "beamline/suggested-experiment.yaml");
  std::ostringstream contents;
  contents << file.rdbuf();
  std::string sample = contents.str();
  sample.replace(sample.find("points: 101"), 11, "points: 3");  // damage would make a hundred a million
  const auto path =
      std::filesystem::temp_directory_path() / ("rabiline_damaged_" + std::to_string(::getpid()) + ".yaml");
  std::mt19937 random(1938);
  int explained = 0;
  for (int i = 0; i < 1000; ++i) {
    std::string text = sample;
    for (int k = 0; k <= i % 3 && !text.empty(); ++k) text = damaged(std::move(text), random);
    std::ofstream(path, std::ios::binary) << text;
    try {
      load_experiment(load_file(path), {});
    } catch (const InputError& error) {
      ++explained;
      EXPECT_FALSE(error.diagnostics().empty()) << text;
      for (const Diagnostic& d : error.diagnostics()) EXPECT_NE(d.message, "") << text;
    }
  }
  EXPECT_GT(explained, 500);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace rabiline::mutation_test
