#include "core/diagnostics.hpp"

#include <algorithm>

#include <gtest/gtest.h>

namespace rabiline::diagnostics_test {
namespace {

std::shared_ptr<const SourceText> text_of(std::vector<std::string> lines) {
  return std::make_shared<SourceText>(SourceText{"a.yaml", std::move(lines)});
}

TEST(Diagnostics, ShowTheLineTheCaretsAndTheHelp) {
  const auto text = text_of({"rabiline: 1", "law: newton"});
  EXPECT_EQ(render({{text, 2, 6, 6}, "no such law", "write `quantum`"}),
            "a.yaml:2:6: error: no such law\n"
            "  2 | law: newton\n"
            "    |      ^^^^^^\n"
            "  help: write `quantum`\n");
}

TEST(Diagnostics, NeedNoPlaceAndNoLine) {
  EXPECT_EQ(render({{}, "nothing", ""}), "error: nothing\n");
  EXPECT_EQ(render({{text_of({}), 0, 0, 1}, "the file is empty", ""}), "a.yaml: error: the file is empty\n");
  EXPECT_EQ(render({{text_of({}), 7, 1, 1}, "far behind", ""}), "a.yaml:7:1: error: far behind\n");
}

TEST(Diagnostics, KeepTheCaretUnderWideCombinedAndTabbedText) {
  // Columns are bytes; a tab shows as four columns, a Chinese character takes two, a combining accent none.
  const auto text = text_of({"\tx", "\u4e2d\u5b50 x", "e\u0301x"});
  EXPECT_EQ(render({{text, 1, 2, 1}, "m", ""}), "a.yaml:1:2: error: m\n  1 |     x\n    |     ^\n");
  EXPECT_EQ(render({{text, 2, 8, 1}, "m", ""}), "a.yaml:2:8: error: m\n  2 | \u4e2d\u5b50 x\n    |      ^\n");
  EXPECT_EQ(render({{text, 3, 4, 1}, "m", ""}), "a.yaml:3:4: error: m\n  3 | e\u0301x\n    |  ^\n");
}

TEST(Diagnostics, PointBehindTheEndOfALine) {
  EXPECT_EQ(render({{text_of({"ab"}), 1, 3, 1}, "m", ""}), "a.yaml:1:3: error: m\n  1 | ab\n    |   ^\n");
}

TEST(Diagnostics, CutAVeryLongLineAroundThePlace) {
  const std::string shown = render({{text_of({std::string(100000, 'a')}), 1, 50000, 3}, "m", ""});
  EXPECT_LT(shown.size(), 600U);
  EXPECT_NE(shown.find("^^^"), std::string::npos);
}

TEST(Diagnostics, CutALongLineBetweenLetters) {
  std::string line;
  for (int i = 0; i < 1000; ++i) line += "\u00e4";  // two bytes each
  for (const int column : {1, 999, 1001, 1999}) {
    const std::string shown = render({{text_of({line}), 1, column, 2}, "m", ""});
    EXPECT_EQ(shown.find('?'), std::string::npos) << shown;
    EXPECT_NE(shown.find('^'), std::string::npos) << shown;
  }
}

TEST(Diagnostics, OfWhichThereAreManyAreCounted) {
  const std::string shown = render(std::vector<Diagnostic>(150, Diagnostic{{}, "again", ""}));
  EXPECT_EQ(std::count(shown.begin(), shown.end(), '\n'), 101);
  EXPECT_TRUE(shown.ends_with("error: again\n... and 50 more\n"));
}

TEST(Diagnostics, ShowNoControlCharacters) {
  const std::string shown = render({{text_of({"a\x1b[31mb"}), 1, 1, 1}, "m", ""});
  EXPECT_EQ(shown.find('\x1b'), std::string::npos);
}

TEST(InputErrors, CarryAllDiagnosticsAndTheirText) {
  const InputError error({{{}, "first", ""}, {{}, "second", ""}});
  EXPECT_EQ(error.diagnostics().size(), 2U);
  EXPECT_STREQ(error.what(), "error: first\nerror: second\n");
}

TEST(Closest, FindsSwappedDroppedAndWrongLetters) {
  const std::vector<std::string> known{"frequency", "amplitude", "phase", "at"};
  EXPECT_EQ(closest("frequnecy", known), "frequency");
  EXPECT_EQ(closest("Amplitud", known), "amplitude");
  EXPECT_EQ(closest("phse", known), "phase");
  EXPECT_EQ(closest("freq", known), "frequency");
  EXPECT_EQ(closest("att", known), "at");
}

TEST(Closest, StaysSilentWhereNothingIsNear) {
  EXPECT_EQ(closest("temperature", {"frequency", "at"}), "");
  EXPECT_EQ(closest("", {"a"}), "");
  EXPECT_EQ(closest("x", {"y"}), "");
  EXPECT_EQ(closest("abc", {}), "");
}

TEST(Diagnostics, ShowNothingThatSteersATerminal) {
  EXPECT_EQ(printable("a\x1b[31m\x7f\xc2\x9b"), "a?[31m??");
  EXPECT_EQ(printable("a\xe2\x80\xae"
                      "b\xe2\x81\xa6\xe2\x80\xa8\xe2\x80\x8f"),
            "a?b???");  // U+202E, U+2066, U+2028, U+200F
  EXPECT_EQ(printable("\xe2\x80\x93 \xe2\x81\xbb\xc2\xb5 \xcf\x80\n"),
            "\xe2\x80\x93 \xe2\x81\xbb\xc2\xb5 \xcf\x80\n");
}

}  // namespace
}  // namespace rabiline::diagnostics_test
