#include "input/yaml_faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rabiline {
namespace {

/// The line without its comment; brackets within quotes as blanks.
std::string without_texts(std::string line) {
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (quote == 0 && line[i] == '#' && (i == 0 || line[i - 1] == ' ')) return line.substr(0, i);
    if (quote != 0 && line[i] == quote)
      quote = 0;
    else if (quote == 0 && (line[i] == '"' || line[i] == '\'') && (i == 0 || line[i - 1] == ' '))
      quote = line[i];
    else if (quote != 0)
      line[i] = ' ';
  }
  return line;
}

/// The brace or bracket in front of a place that is still open there.
std::optional<Place> last_open(const Place& place) {
  std::vector<Place> open;
  for (int number = 1; number <= place.line && number <= static_cast<int>(place.text->lines.size());
       ++number) {
    std::string line = without_texts(place.text->lines[static_cast<std::size_t>(number) - 1]);
    if (number == place.line)
      line.resize(std::min(line.size(), static_cast<std::size_t>(std::max(place.column - 1, 0))));
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (line[i] == '{' || line[i] == '[') open.push_back({place.text, number, static_cast<int>(i) + 1, 1});
      if ((line[i] == '}' || line[i] == ']') && !open.empty()) open.pop_back();
    }
  }
  return open.empty() ? std::nullopt : std::optional(open.back());
}

/// A unit behind the numbers that it is meant for: `values: [1, 2] mT`.
std::optional<Diagnostic> unit_behind_list(const Place& place) {
  const auto number = static_cast<std::size_t>(place.line - 1),
             at = static_cast<std::size_t>(place.column - 1);
  const std::vector<std::string>& lines = place.text->lines;
  if (number >= lines.size() || at >= lines[number].size()) return std::nullopt;
  const std::string& line = lines[number];
  const std::size_t closed = line.rfind(']', at);
  if (closed == line.npos) return std::nullopt;
  const std::size_t begin = line.find_first_not_of(' ', closed + 1);
  if (begin > at || line.find_first_of("0123456789-+.\"'[{,}]", begin) == begin) return std::nullopt;
  const std::size_t end = std::min(line.find_first_of(" ,}", begin), line.size());
  if (end <= at) return std::nullopt;
  return Diagnostic{{place.text, place.line, static_cast<int>(begin) + 1, static_cast<int>(end - begin)},
                    "this stands behind a list, to which it does not belong",
                    fmt::format("a unit stands with each of the numbers: `[1 {0}, 2 {0}]`",
                                line.substr(begin, end - begin))};
}

/// A key that goes on where a value should have ended: `length: 1 m field: 1 T`.
std::optional<Diagnostic> missing_comma(const Place& colon) {
  const auto at = static_cast<std::size_t>(colon.column - 1);
  const auto number = static_cast<std::size_t>(colon.line - 1);
  const std::vector<std::string>& lines = colon.text->lines;
  if (number >= lines.size() || at >= lines[number].size() || lines[number][at] != ':') return std::nullopt;
  const std::string before = lines[number].substr(0, at);
  const std::size_t gap = before.find_last_of(" ,{");
  const std::size_t begin = gap == before.npos ? 0 : gap + 1;
  const std::string key = before.substr(begin);
  if (key.empty()) return std::nullopt;
  if (before.find_first_not_of(' ') < begin)
    return Diagnostic{{colon.text, colon.line, static_cast<int>(begin) + 1, static_cast<int>(key.size())},
                      fmt::format("a comma is missing in front of `{}`", key),
                      "a comma stands between the keys of one `{}`"};
  for (std::size_t above = number; above-- > 0;) {
    const std::size_t end = without_texts(lines[above]).find_last_not_of(' ');
    if (end == std::string::npos) continue;
    return Diagnostic{{colon.text, static_cast<int>(above) + 1, static_cast<int>(end) + 1, 1},
                      fmt::format("a `}}` or a comma is missing behind this, in front of `{}`", key),
                      "a `{` ends with a `}`, and commas stand between its keys"};
  }
  return std::nullopt;
}

/// `law:quantum`, `law quantum` or `parts` in a line of its own above a key: both lines are one text for
/// YAML.
std::optional<Diagnostic> incomplete_colon(const Place& colon) {
  const std::vector<std::string>& lines = colon.text->lines;
  for (auto above = std::min(static_cast<std::size_t>(colon.line - 1), lines.size()); above-- > 0;) {
    const std::string line = without_texts(lines[above]);
    const std::size_t end = line.find_last_not_of(' ');
    if (end == line.npos) continue;
    const std::size_t begin = line.find_first_not_of(" -"), narrow = line.find(':'),
                      gap = std::min(line.find(' ', begin), end + 1);
    if (narrow == line.npos && begin < end) {
      const std::string key = line.substr(begin, gap - begin);
      const std::string value = line.substr(gap, end + 1 - gap);
      return Diagnostic{{colon.text, static_cast<int>(above) + 1, static_cast<int>(begin) + 1,
                         static_cast<int>(gap - begin)},
                        fmt::format("a colon is missing behind `{}`", key),
                        fmt::format("write `{}:{}`", key, value)};
    }
    if (narrow == line.npos || narrow <= begin || narrow >= end || line[narrow + 1] == ' ' || gap < narrow)
      return std::nullopt;
    const std::string key = line.substr(begin, narrow - begin);
    return Diagnostic{{colon.text, static_cast<int>(above) + 1, static_cast<int>(begin) + 1,
                       static_cast<int>(narrow - begin) + 1},
                      "a space is missing behind the colon",
                      fmt::format("write `{}: {}`", key, line.substr(narrow + 1, end - narrow))};
  }
  return std::nullopt;
}

/// An apostrophe within '...' ends it, and what follows is another text.
bool is_behind_quote(const Place& place) {
  const auto number = static_cast<std::size_t>(place.line - 1),
             at = static_cast<std::size_t>(place.column - 1);
  const std::vector<std::string>& lines = place.text->lines;
  return number < lines.size() && at > 0 && at < lines[number].size() &&
         (lines[number][at - 1] == '\'' || lines[number][at - 1] == '"');
}

/// `slit: {at: 1 m}` below items of a list, or an item of a list without its key.
std::optional<Diagnostic> stray_item(const Place& key) {
  const std::vector<std::string>& lines = key.text->lines;
  const auto number = static_cast<std::size_t>(key.line - 1),
             column = static_cast<std::size_t>(key.column - 1);
  if (number == 0 || number >= lines.size() || column >= lines[number].size()) return std::nullopt;
  const std::string &above = lines[number - 1], &here = lines[number];
  if (here.compare(column, 2, "- ") == 0)
    return Diagnostic{key, "this item belongs to no list",
                      "the key of its list is missing above it, such as `parts:`"};
  const std::size_t colon = here.find_first_of(here[column] == '{' ? "," : ":", column);
  if (colon == here.npos || above.find_first_not_of(' ') != column || above.compare(column, 2, "- ") != 0)
    return std::nullopt;
  if (here[column] == '-' && column + 1 < here.size())
    return Diagnostic{key, "a space is missing behind the dash",
                      fmt::format("write `- {}`", here.substr(column + 1))};
  return Diagnostic{key, "this stands among the items of a list, and is none",
                    fmt::format("begin it with a dash, as the one above it: `- {}{}, ...}}`",
                                here[column] == '{' ? "" : "{name: ", here.substr(column, colon - column))};
}

}  // namespace

Diagnostic explain_yaml(Place place, std::string_view message) {
  if (place.text && message.find("end of map flow not found") != message.npos)
    for (const auto& explained : {missing_comma(place), unit_behind_list(place)})
      if (explained) return *explained;
  if (place.text && message.find("illegal block entry") != message.npos)
    if (const std::optional<Place> open = last_open(place))
      return {*open, "this is never closed", "a `}` or `]` is missing in front of the next item"};
  if (place.text && message.find("illegal map value") != message.npos)
    if (std::optional<Diagnostic> missing = incomplete_colon(place)) return *std::move(missing);
  if (place.text && message.find("end of map not found") != message.npos && is_behind_quote(place))
    return {std::move(place), "the text has ended at the quote in front of this",
            "a text with an apostrophe stands between \"...\", one with a \" between '...'"};
  if (place.text && message.find("end of map not found") != message.npos)
    if (std::optional<Diagnostic> item = stray_item(place)) return *std::move(item);
  struct Case {
    std::string_view message, problem, help;
  };
  static constexpr Case cases[] = {
      {"end of map flow not found", "a `{` is never closed",
       "a `}` or a comma is missing, in this line or above"},
      {"end of sequence flow not found", "a `[` is never closed",
       "a `]` or a comma is missing, in this line or above"},
      {"end of map not found", "this key stands in another column than the keys it belongs to",
       "keys that belong together begin in the same column"},
      {"end of sequence not found", "this item stands in another column than the items it belongs to",
       "items of a list begin in the same column, each with `- `"},
      {"illegal map value", "a second colon makes no sense here",
       "a text that holds `: ` stands in quotes; or a brace or a line end is missing before it, or the line "
       "is "
       "indented further than the keys above it"},
      {"illegal flow end", "this closes what was not opened, or something before it is still open",
       "compare the brackets and braces"},
  };
  for (const Case& c : cases)
    if (message.find(c.message) != message.npos)
      return {std::move(place), std::string(c.problem), std::string(c.help)};
  return {std::move(place), fmt::format("this is not YAML: {}", message), {}};
}

}  // namespace rabiline
