#include "core/diagnostics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>

#include "core/text.hpp"

namespace rabiline {
namespace {

/// How many columns a terminal gives to a character: two for East Asian wide ones and emoji, none for marks.
int width_of(char32_t c) {
  struct Interval {
    char32_t first, last;
  };
  static constexpr Interval none[] = {{0x300, 0x36f}, {0x200b, 0x200f}, {0x20d0, 0x20ff}, {0xfe00, 0xfe0f}};
  static constexpr Interval wide[] = {{0x1100, 0x115f}, {0x2e80, 0xa4cf},   {0xac00, 0xd7a3},
                                      {0xf900, 0xfaff}, {0xfe30, 0xfe6f},   {0xff00, 0xff60},
                                      {0xffe0, 0xffe6}, {0x1f300, 0x1faff}, {0x20000, 0x3fffd}};
  const auto holds = [c](const Interval& i) { return c >= i.first && c <= i.last; };
  if (std::any_of(std::begin(none), std::end(none), holds)) return 0;
  return std::any_of(std::begin(wide), std::end(wide), holds) ? 2 : 1;
}

/// One character of a shown line: what is printed for it, where it began in the text and how wide it is.
struct Glyph {
  std::string print;
  int byte;
  int width;
};

/// Tabs become four spaces and other control characters a question mark, so that columns align everywhere.
std::vector<Glyph> glyphs_of(const std::string& line) {
  std::vector<Glyph> out;
  for (std::size_t i = 0; i < line.size();) {
    const auto lead = static_cast<unsigned char>(line[i]);
    std::size_t size = lead < 0x80 ? 1 : lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : lead >= 0xc0 ? 2 : 1;
    size = std::min(size, line.size() - i);
    char32_t c = size == 1 ? lead : lead & (0x7fU >> size);
    for (std::size_t k = 1; k < size; ++k) c = (c << 6) | (static_cast<unsigned char>(line[i + k]) & 0x3fU);
    if (lead == '\t')
      out.push_back({"    ", static_cast<int>(i), 4});
    else if (lead < 0x20 || lead == 0x7f || (size == 1 && lead >= 0x80))
      out.push_back({"?", static_cast<int>(i), 1});
    else
      out.push_back({line.substr(i, size), static_cast<int>(i), width_of(c)});
    i += size;
  }
  return out;
}

/// The line and the carets under the place; of a very long line only the surroundings.
std::string excerpt(const Place& place, const std::string& whole) {
  static constexpr std::size_t before = 80, window = 200, longest_letter = 4;
  // Only those are looked at: many messages about one long line would take long.
  const std::size_t column = std::min<std::size_t>(static_cast<std::size_t>(place.column - 1), whole.size());
  std::size_t begin = column - std::min(column, longest_letter * (before + 1));
  while (begin > 0 && (static_cast<unsigned char>(whole[begin]) & 0xc0) == 0x80) --begin;
  const std::string line = whole.substr(begin, 2 * longest_letter * window);
  const std::vector<Glyph> glyphs = glyphs_of(line);
  std::size_t at = 0;
  while (at < glyphs.size() && glyphs[at].byte < static_cast<int>(column - begin)) ++at;
  std::size_t first = 0, last = glyphs.size();
  if (glyphs.size() > window) {
    first = at > before ? at - before : 0;
    last = std::min(glyphs.size(), first + window);
  }
  const bool is_cut = first > 0 || begin > 0;
  std::string shown = is_cut ? "..." : "", marks = is_cut ? "   " : "";
  for (std::size_t i = first; i < last; ++i) {
    shown += glyphs[i].print;
    if (i < at) marks.append(static_cast<std::size_t>(glyphs[i].width), ' ');
    if (i >= at && i < at + static_cast<std::size_t>(std::max(place.length, 1)))
      marks.append(static_cast<std::size_t>(glyphs[i].width), '^');
  }
  if (last < glyphs.size() || begin + line.size() < whole.size()) shown += "...";
  if (at >= glyphs.size()) marks += '^';
  const std::string number = std::to_string(place.line);
  return fmt::format("  {} | {}\n  {} | {}\n", number, shown, std::string(number.size(), ' '), marks);
}

/// Letters to insert, drop, replace or swap with a neighbour (optimal string alignment).
constexpr std::size_t longest_word = 64, most_edits = longest_word / 3 + 1;

/// Of words of no more than these letters, neither longer than the other by more than those edits.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::array<std::array<std::size_t, longest_word + most_edits + 1>, longest_word + 1> d;
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i)
    for (std::size_t j = 1; j <= b.size(); ++j) {
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

}  // namespace

std::string render(const Diagnostic& d) {
  std::string out;
  const SourceText* text = d.place.text.get();
  const std::string_view word = d.severity == Severity::warning ? "warning" : "error";
  if (text && d.place.line > 0)
    out = fmt::format("{}:{}:{}: {}: {}\n", text->name, d.place.line, d.place.column, word, d.message);
  else if (text)
    out = fmt::format("{}: {}: {}\n", text->name, word, d.message);
  else
    out = fmt::format("{}: {}\n", word, d.message);
  if (text && d.place.line > 0 && static_cast<std::size_t>(d.place.line) <= text->lines.size())
    out += excerpt(d.place, text->lines[static_cast<std::size_t>(d.place.line) - 1]);
  if (!d.suggestion.empty()) out += fmt::format("  help: {}\n", d.suggestion);
  return out;
}

std::string render(const std::vector<Diagnostic>& diagnostics) {
  static constexpr std::size_t most = 100;  // more are of one kind
  std::string out;
  for (std::size_t i = 0; i < std::min(most, diagnostics.size()); ++i) out += render(diagnostics[i]);
  if (diagnostics.size() > most) out += fmt::format("... and {} more\n", diagnostics.size() - most);
  return out;
}

InputError::InputError(std::vector<Diagnostic> diagnostics)
    : std::runtime_error(render(diagnostics)), diagnostics_(std::move(diagnostics)) {}

namespace {

/// Characters of three bytes that turn the direction of a line around or end it: U+200E, U+200F, U+2028 to
/// U+202E, U+2066 to U+2069.
bool turns_lines(std::string_view letter) {
  const auto last = static_cast<unsigned char>(letter.back());
  if (letter.starts_with("\xe2\x80")) return (last >= 0x8e && last <= 0x8f) || (last >= 0xa8 && last <= 0xae);
  return letter.starts_with("\xe2\x81") && last >= 0xa6 && last <= 0xa9;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t size = lead < 0x80   ? 1
                             : lead < 0xc2 ? 0
                             : lead < 0xe0 ? 2
                             : lead < 0xf0 ? 3
                             : lead < 0xf5 ? 4
                                           : 0;
    bool whole = size > 0 && i + size <= text.size();
    for (std::size_t k = 1; whole && k < size; ++k)
      whole = (static_cast<unsigned char>(text[i + k]) & 0xc0) == 0x80;
    const bool control = (lead < 0x20 && lead != '\n') || lead == 0x7f ||
                         (whole && lead == 0xc2 && static_cast<unsigned char>(text[i + 1]) < 0xa0) ||
                         (whole && size == 3 && turns_lines(text.substr(i, 3)));
    if (whole && !control)
      out += text.substr(i, size);
    else
      out += '?';
    i += whole ? size : 1;
  }
  return out;
}

std::string closest(std::string_view word, const std::vector<std::string>& known) {
  if (word.empty() || word.size() > longest_word) return {};
  const std::string wanted = lower(word);
  std::string best;
  std::size_t best_distance =
      std::max<std::size_t>(word.size() < 4 ? 1 : 2, word.size() / 3) + 1;  // at most `most_edits` + 1
  for (const std::string& candidate : known) {
    const std::string other = lower(candidate);
    if (wanted.size() >= 3 && best_distance > 1 && other.starts_with(wanted)) {
      best = candidate;
      best_distance = 1;
      continue;
    }
    if (std::max(wanted.size(), other.size()) - std::min(wanted.size(), other.size()) >= best_distance)
      continue;
    const std::size_t distance = edit_distance(wanted, other);
    if (distance >= best_distance || distance >= std::max(wanted.size(), other.size())) continue;
    best = candidate;
    best_distance = distance;
  }
  return best;
}

}  // namespace rabiline
