#include "scan/scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "input/reader.hpp"
#include "scan/dotted_name.hpp"

namespace rabiline {
namespace {

std::optional<ParsedQuantity> end_of_range(const Node& node, std::string_view key, std::string_view listed,
                                           Reading& reading) {
  const ParsedQuantity parsed =
      node.is_scalar() ? parse_quantity(node.scalar)
                       : ParsedQuantity{0, Dimension::number, "is not a number", {}, Misread::not_a_number};
  if (parsed.error.empty()) return parsed;
  const bool unit = parsed.misread != Misread::not_a_number;
  reading.error(
      node.place, fmt::format("`{}` begins or ends a range, but {} {}", key, quote(node), parsed.error),
      unit ? parsed.suggestion : fmt::format("write what is not a number one by one: `{}`", listed));
  return std::nullopt;
}

/// The value at `part` of the way, in equal ratios, to 15 digits, so that decades are whole numbers.
double between_logarithmic(double first, double last, double part) {
  const auto ratio = static_cast<long double>(last) / first;
  const std::string text =
      fmt::format("{:.14e}", static_cast<double>(first * std::pow(ratio, static_cast<long double>(part))));
  double out = 0;
  std::from_chars(text.data(), text.data() + text.size(), out);
  return out;
}

/// A range in equal ratios has both ends on the same side of zero.
bool has_ratio(const Node& from, const Node& to, double first, double last, Reading& reading) {
  if (first != 0 && last != 0 && (first > 0) == (last > 0)) return true;
  const Node& wrong = first == 0 ? from : to;
  reading.error(wrong.place,
                first == 0 || last == 0
                    ? fmt::format("a logarithmic range cannot {} at zero, but {} stands here",
                                  first == 0 ? "begin" : "end", quote(wrong))
                    : fmt::format("a logarithmic range cannot cross zero, but it goes from {} to {}",
                                  quote(from), quote(to)),
                "both ends are on the same side of zero, or the spacing is linear");
  return false;
}

/// The range, or no values where something is wrong with it; `listed` is how values stand one by one.
decltype(Axis::values) range_values(const Node& from, const Node& to, std::uint64_t points,
                                    ScanSpacing spacing, std::string_view listed, Reading& reading) {
  const std::vector<Node> none;
  const auto first = end_of_range(from, "from", listed, reading);
  const auto last = end_of_range(to, "to", listed, reading);
  if (!first || !last) return none;
  if (first->dimension != last->dimension) {
    reading.error(
        to.place,
        fmt::format("the range begins with {} and ends with {}", with_article(name_of(first->dimension)),
                    with_article(name_of(last->dimension))),
        "both ends need a unit of the same kind");
    return none;
  }
  if (first->value == last->value) {
    reading.error(to.place, fmt::format("the range ends where it begins, at {}", quote(from)),
                  "a single value is set with --set");
    return none;
  }
  if (spacing == ScanSpacing::logarithmic && !has_ratio(from, to, first->value, last->value, reading))
    return none;
  return Axis::Range{from, to, first->value, last->value, first->dimension, points, spacing};
}

std::vector<Node> listed_values(const Node& list, Reading& reading) {
  if (list.is_sequence() && !list.items.empty()) {
    if (static_cast<double>(list.items.size()) <= max_scan_points) return list.items;
  }
  reading.error(list.place,
                fmt::format("`values` is a list of one or more values, but {} stands here",
                            list.is_sequence() ? "an empty one" : quote(list)),
                "write it like `values: [1 mT, 2 mT, 5 mT]`");
  return {};
}

/// The file's entry as an axis; one without values where something is wrong.
Axis read_entry(const Node& node, const Place& named_at, Reading& reading,
                std::optional<ScanParticles>& particles) {
  Axis axis;
  ScanEntry entry;
  if (!node.is_mapping()) {
    reading.error(node.place, fmt::format("`scan` is a mapping of keys, but {} stands here", quote(node)),
                  "write it like `scan: {parameter: H0.frequency, from: 280 kHz, to: 300 kHz, points: 21}`");
    return axis;
  }
  if (!read_struct(node, named_at, {"scan", Dimension::number, range::any, ""}, reading, entry)) return axis;
  axis.parameters = entry.parameter.names;
  axis.place = axis.parameters.front().place;
  if (entry.particles) particles = entry.particles;
  const Place& blame = node.find("parameter")->key_place;
  if (entry.values && (entry.from || entry.to || entry.points))
    reading.error(node.find("values")->key_place, "a scan has either `values`, or `from`, `to` and `points`",
                  "keep one of the two");
  else if (entry.values && entry.spacing)
    reading.error(node.find("spacing")->key_place,
                  "`spacing` spreads the values of a range, but here they are written one by one",
                  "omit it, or give `from`, `to` and `points`");
  else if (entry.values)
    axis.values = listed_values(*entry.values, reading);
  else if (!entry.from && !entry.to && !entry.points)
    reading.error(blame, fmt::format("the scan of `{}` does not say over which values", axis.name()),
                  "add `from`, `to` and `points`, or `values`");
  else if (!entry.from || !entry.to || !entry.points)
    reading.error(blame,
                  fmt::format("the scan of `{}` lacks `{}`", axis.name(),
                              !entry.from ? "from"
                              : !entry.to ? "to"
                                          : "points"),
                  "a range has `from`, `to` and `points`");
  else
    axis.values = range_values(*entry.from, *entry.to, *entry.points,
                               entry.spacing.value_or(ScanSpacing::linear), "values: [...]", reading);
  return axis;
}

/// Where an argument has that separator outside brackets and quotes.
std::vector<std::size_t> separators(std::string_view text, std::size_t from, char separator) {
  std::vector<std::size_t> out;
  int depth = 0;
  char quoted = 0;
  for (std::size_t i = from; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == quoted) quoted = 0;
    } else if (c == '"' || c == '\'')
      quoted = c;
    else if (c == '{' || c == '[')
      ++depth;
    else if (c == '}' || c == ']')
      --depth;
    else if (c == separator && depth == 0)
      out.push_back(i);
  }
  return out;
}

/// The names before the equals sign of an argument, with commas between.
std::vector<NamedAt> names_before(std::size_t equals, const std::shared_ptr<const SourceText>& source) {
  const std::string_view names = std::string_view(source->lines.front()).substr(0, equals);
  std::vector<NamedAt> out;
  for (std::size_t from = 0; from <= names.size();) {
    const std::size_t end = std::min(names.find(',', from), names.size());
    std::size_t first = from, last = end;
    while (first < last && names[first] == ' ') ++first;
    while (last > first && names[last - 1] == ' ') --last;
    out.push_back({std::string(names.substr(first, last - first)),
                   {source, 1, static_cast<int>(first) + 1, std::max(1, static_cast<int>(last - first))}});
    from = end + 1;
  }
  return out;
}

/// "280 kHz:300 kHz" for `280 kHz-300 kHz` and the like; empty for what is no range.
std::string meant_as_range(std::string_view text) {
  const auto is_quantity = [](std::string_view part) { return parse_quantity(part).error.empty(); };
  for (const std::string_view between : {"..", " to ", "-"})
    for (std::size_t at = text.find(between, 1); at < text.size(); at = text.find(between, at + 1)) {
      const std::string_view from = text.substr(0, at), to = text.substr(at + between.size());
      if (is_quantity(from) && is_quantity(to)) return fmt::format("{}:{}", from, to);
    }
  return {};
}

/// NAME=FROM:TO:POINTS, NAME=FROM:TO:POINTS:log or NAME=A,B,C; several names have commas between.
Axis read_argument(const std::shared_ptr<const SourceText>& source, Reading& reading) {
  Axis axis;
  if (!is_one_line(source, reading)) return axis;
  const std::string& text = source->lines.front();
  const std::size_t equals = text.find('=');
  const Place whole{source, 1, 1, std::max(1, static_cast<int>(text.size()))};
  if (equals != std::string::npos && equals > 0 && equals + 1 == text.size()) {
    reading.error(
        whole, fmt::format("the scan of `{}` has no values", text.substr(0, equals)),
        fmt::format("write them behind it, as `{0}=FROM:TO:POINTS` or `{0}=A,B,C`", text.substr(0, equals)));
    return axis;
  }
  if (equals == std::string::npos || equals == 0) {
    reading.error(whole, "a scan on the command line is NAME=FROM:TO:POINTS[:log] or NAME=A,B,C",
                  "such as `H0.frequency=280 kHz:300 kHz:21` or `law=quantum,dorado`");
    return axis;
  }
  axis.parameters = names_before(equals, source);
  for (const NamedAt& named : axis.parameters)
    if (named.name.empty()) {
      reading.error(named.place, "the name of a parameter is missing here", "such as `H0.frequency`");
      return axis;
    }
  axis.place = {source, 1, 1, static_cast<int>(equals)};
  const std::vector<std::size_t> colons = separators(text, equals + 1, ':');
  std::vector<std::size_t> cuts = separators(text, equals + 1, ',');
  const bool range = cuts.empty() && !colons.empty();
  const std::string meant =
      cuts.empty() && !range ? meant_as_range(std::string_view(text).substr(equals + 1)) : "";
  if (!meant.empty() || (range && colons.size() != 2 && colons.size() != 3)) {
    reading.error({source, 1, static_cast<int>(equals) + 2, static_cast<int>(text.size() - equals - 1)},
                  "a range is FROM:TO:POINTS, or FROM:TO:POINTS:log",
                  meant.empty() ? "such as `280 kHz:300 kHz:21` or `1 nT:1 mT:31:log`"
                                : fmt::format("write `{}:21` for 21 points", meant));
    return axis;
  }
  if (range) cuts = colons;
  cuts.push_back(text.size());
  std::vector<Node> nodes;
  for (std::size_t from = equals + 1; const std::size_t cut : cuts) {
    nodes.push_back(parse_value(source, from, cut - from));
    if (nodes.back().is_null()) {
      reading.error({source, 1, static_cast<int>(from) + 1, 1}, "a value is missing here");
      return axis;
    }
    from = cut + 1;
  }
  std::uint64_t points = 0;
  if (!range)
    axis.values = std::move(nodes);
  else if (nodes.size() == 4 && nodes[3].scalar != "log")
    reading.error(nodes[3].place,
                  fmt::format("after the points of a range stands `log` or nothing, but {} stands here",
                              quote(nodes[3])),
                  "write `FROM:TO:POINTS:log` for equal ratios, `FROM:TO:POINTS` for equal steps");
  else if (read_count(nodes[2], {"points", Dimension::number, scan_points, ""}, reading, points))
    axis.values = range_values(nodes[0], nodes[1], points,
                               nodes.size() == 4 ? ScanSpacing::logarithmic : ScanSpacing::linear,
                               axis.name() + "=A,B,C", reading);
  return axis;
}

void check_axes(const std::vector<Axis>& axes, Reading& reading) {
  std::vector<const NamedAt*> names;
  double total = 1;
  for (const Axis& axis : axes) {
    for (const NamedAt& named : axis.parameters) {
      const auto other = std::find_if(names.begin(), names.end(), [&](const NamedAt* before) {
        return names_overlap(before->name, named.name);
      });
      if (other != names.end()) {
        const bool same = (*other)->name == named.name;
        reading.error(
            named.place,
            same ? fmt::format("`{}` is scanned twice", named.name)
                 : fmt::format("`{}` and `{}` cannot be scanned together: one is a part of the other",
                               (*other)->name, named.name),
            same ? "join the values in one scan" : "write the combinations as `values` of the whole");
      }
      names.push_back(&named);
    }
    total *= static_cast<double>(axis.size());
  }
  if (total > max_scan_points)
    reading.error(axes.back().place,
                  fmt::format("the grid has {} points, more than {}", total, max_scan_points),
                  "scan fewer points");
}

bool share_a_parameter(const Axis& a, const Axis& b) {
  return std::any_of(a.parameters.begin(), a.parameters.end(), [&](const NamedAt& one) {
    return std::any_of(b.parameters.begin(), b.parameters.end(),
                       [&](const NamedAt& other) { return one.name == other.name; });
  });
}

}  // namespace

bool scans_variables(const ScanPlan& plan) {
  return std::any_of(plan.axes.begin(), plan.axes.end(), [](const Axis& axis) {
    return std::any_of(axis.parameters.begin(), axis.parameters.end(),
                       [](const NamedAt& named) { return named.name.starts_with("variables."); });
  });
}

std::size_t Axis::size() const {
  const auto* range = std::get_if<Range>(&values);
  return range ? range->points : std::get<std::vector<Node>>(values).size();
}

Node Axis::value(std::size_t point) const {
  const auto* range = std::get_if<Range>(&values);
  if (!range) return std::get<std::vector<Node>>(values)[point];
  if (point == 0) return range->from;
  if (point + 1 == range->points) return range->to;
  const auto steps = static_cast<double>(range->points - 1), step = static_cast<double>(point);
  Node node = range->to;  // the end to blame, since what begins the range has been found good
  node.scalar = write_quantity(range->spacing == ScanSpacing::logarithmic
                                   ? between_logarithmic(range->first, range->last, step / steps)
                                   : (range->first * (steps - step) + range->last * step) / steps,
                               range->dimension);
  return node;
}

std::string Axis::name() const {
  std::string out;
  for (const NamedAt& named : parameters) out += (out.empty() ? "" : ", ") + named.name;
  return out;
}

bool ValueType<ScannedNames>::read(const Node& node, const Row& row, Reading& reading, ScannedNames& out) {
  out.names.clear();
  if (node.is_sequence() && node.items.empty()) {
    reading.error(node.place, fmt::format("`{}` names no parameter", row.key), "write one, or several");
    return false;
  }
  const std::vector<Node> one{node};
  for (const Node& item : node.is_sequence() ? node.items : one) {
    NamedAt& named = out.names.emplace_back();
    if (!read_text(item, row, reading, named.name)) return false;
    named.place = item.place;
    if (!item.quoted) continue;
    ++named.place.column;
    named.place.length -= 2;
  }
  return true;
}

bool is_one_line(const std::shared_ptr<const SourceText>& argument, Reading& reading) {
  if (argument->lines.size() == 1) return true;
  const int length = std::max(1, static_cast<int>(argument->lines[1].size()));
  reading.error({argument, 2, 1, length}, fmt::format("what follows {} is one line", argument->name),
                argument->name.ends_with("set")
                    ? "set each value by itself; lists and mappings stand in brackets: "
                      "`[1, 2]`, `{radius: 1 mm}`"
                    : "write it in one line");
  return false;
}

ScanPlan read_scan(const Node* root, const std::vector<std::shared_ptr<const SourceText>>& arguments,
                   Reading& reading) {
  ScanPlan plan;
  const std::size_t errors = reading.errors.size();
  if (const Entry* scan = root ? root->find("scan") : nullptr) {
    std::vector<std::pair<const Node*, const Place*>> entries;
    if (scan->value.is_sequence())
      for (const Node& item : scan->value.items) entries.emplace_back(&item, &item.place);
    else
      entries.emplace_back(&scan->value, &scan->key_place);
    std::optional<ScanParticles> mode;
    for (const auto& [node, named_at] : entries) {
      std::optional<ScanParticles> particles;
      plan.axes.push_back(read_entry(*node, *named_at, reading, particles));
      if (mode && particles && *mode != *particles)
        reading.error(place_of(*node, "particles"), "the two scans disagree on `particles`",
                      "all points share their particles, or none do");
      if (particles) mode = particles;
    }
    plan.particles = mode.value_or(ScanParticles::shared);
  }
  std::vector<Axis> outer;
  for (const auto& argument : arguments) {
    Axis axis = read_argument(argument, reading);
    const auto same = std::find_if(plan.axes.begin(), plan.axes.end(),
                                   [&](const Axis& a) { return share_a_parameter(a, axis); });
    if (same != plan.axes.end() && !same->place.text->name.starts_with("--"))
      *same = std::move(axis);
    else
      outer.push_back(std::move(axis));
  }
  plan.axes.insert(plan.axes.begin(), std::make_move_iterator(outer.begin()),
                   std::make_move_iterator(outer.end()));
  if (reading.errors.size() == errors) check_axes(plan.axes, reading);
  return plan;
}

}  // namespace rabiline
