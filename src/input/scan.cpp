#include "input/scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "input/dotted_name.hpp"
#include "input/reader.hpp"

namespace rabiline {
namespace {

std::optional<ParsedQuantity> end_of_range(const Node& node, std::string_view key, Reading& reading) {
  const ParsedQuantity parsed =
      node.is_scalar() ? parse_quantity(node.scalar)
                       : ParsedQuantity{0, Dimension::number, "is not a number", {}, Misread::not_a_number};
  if (parsed.error.empty()) return parsed;
  const bool unit = parsed.misread != Misread::not_a_number;
  reading.error(node.place,
                fmt::format("`{}` begins or ends a range, but {} {}", key, quote(node), parsed.error),
                unit ? parsed.suggestion : "write what is no number one by one: `values: [...]`");
  return std::nullopt;
}

/// The value at `part` of the way, in equal ratios, to 15 digits: so that decades are whole numbers, the same
/// on every processor.
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

/// Both ends keep their text, so they are exact; the values between are written in SI, which loses no bit.
std::vector<Node> range_values(const Node& from, const Node& to, std::uint64_t points, ScanSpacing spacing,
                               Reading& reading) {
  const auto first = end_of_range(from, "from", reading);
  const auto last = end_of_range(to, "to", reading);
  if (!first || !last) return {};
  if (first->dimension != last->dimension) {
    reading.error(
        to.place,
        fmt::format("the range begins with {} and ends with {}", with_article(name_of(first->dimension)),
                    with_article(name_of(last->dimension))),
        "both ends need a unit of the same kind");
    return {};
  }
  if (first->value == last->value) {
    reading.error(to.place, fmt::format("the range ends where it begins, at {}", quote(from)),
                  "a single value is set with --set");
    return {};
  }
  const bool logarithmic = spacing == ScanSpacing::logarithmic;
  if (logarithmic && !has_ratio(from, to, first->value, last->value, reading)) return {};
  std::vector<Node> values(points, from);
  const auto steps = static_cast<double>(points - 1);
  for (std::uint64_t i = 1; i + 1 < points; ++i) {
    const auto step = static_cast<double>(i);
    const double between = logarithmic ? between_logarithmic(first->value, last->value, step / steps)
                                       : (first->value * (steps - step) + last->value * step) / steps;
    values[i].scalar = write_quantity(between, first->dimension);
  }
  values.back() = to;
  return values;
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
  axis.parameter = entry.parameter;
  axis.place = place_of(node, "parameter");
  if (node.find("parameter")->value.quoted) {
    ++axis.place.column;
    axis.place.length -= 2;
  }
  if (entry.particles) particles = entry.particles;
  const Place& blame = node.find("parameter")->key_place;
  if (entry.values && (entry.from || entry.to || entry.points))
    reading.error(node.find("values")->key_place, "a scan has either `values`, or `from`, `to` and `points`",
                  "keep one of the two");
  else if (entry.values && entry.spacing)
    reading.error(node.find("spacing")->key_place,
                  "`spacing` spreads the values of a range, but here they are written one by one",
                  "leave it away, or give `from`, `to` and `points`");
  else if (entry.values)
    axis.values = listed_values(*entry.values, reading);
  else if (!entry.from && !entry.to && !entry.points)
    reading.error(blame, fmt::format("the scan of `{}` does not say over which values", axis.parameter),
                  "add `from`, `to` and `points`, or `values`");
  else if (!entry.from || !entry.to || !entry.points)
    reading.error(blame,
                  fmt::format("the scan of `{}` lacks `{}`", axis.parameter,
                              !entry.from ? "from"
                              : !entry.to ? "to"
                                          : "points"),
                  "a range has `from`, `to` and `points`");
  else {
    axis.is_range = true;
    axis.values = range_values(*entry.from, *entry.to, *entry.points,
                               entry.spacing.value_or(ScanSpacing::linear), reading);
  }
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

/// NAME=FROM:TO:POINTS, NAME=FROM:TO:POINTS:log or NAME=A,B,C.
Axis read_argument(const std::shared_ptr<const SourceText>& source, Reading& reading) {
  Axis axis;
  const std::string& text = source->lines.front();
  const std::size_t equals = text.find('=');
  const Place whole{source, 1, 1, std::max(1, static_cast<int>(text.size()))};
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    reading.error(whole, "a scan on the command line is NAME=FROM:TO:POINTS[:log] or NAME=A,B,C",
                  "such as `H0.frequency=280 kHz:300 kHz:21` or `law=quantum,dorado`");
    return axis;
  }
  axis.parameter = text.substr(0, equals);
  axis.place = {source, 1, 1, static_cast<int>(equals)};
  const std::vector<std::size_t> colons = separators(text, equals + 1, ':');
  std::vector<std::size_t> cuts = separators(text, equals + 1, ',');
  const bool range = cuts.empty() && !colons.empty();
  if (range && colons.size() != 2 && colons.size() != 3) {
    reading.error({source, 1, static_cast<int>(equals) + 2, static_cast<int>(text.size() - equals - 1)},
                  "a range is FROM:TO:POINTS, or FROM:TO:POINTS:log",
                  "such as `280 kHz:300 kHz:21` or `1 nT:1 mT:31:log`");
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
  axis.is_range = range;
  if (!range)
    axis.values = std::move(nodes);
  else if (nodes.size() == 4 && nodes[3].scalar != "log")
    reading.error(nodes[3].place,
                  fmt::format("after the points of a range stands `log` or nothing, but {} stands here",
                              quote(nodes[3])),
                  "write `FROM:TO:POINTS:log` for equal ratios, `FROM:TO:POINTS` for equal steps");
  else if (read_count(nodes[2], {"points", Dimension::number, scan_points, ""}, reading, points))
    axis.values = range_values(nodes[0], nodes[1], points,
                               nodes.size() == 4 ? ScanSpacing::logarithmic : ScanSpacing::linear, reading);
  return axis;
}

void check_axes(const std::vector<Axis>& axes, Reading& reading) {
  if (axes.size() > 2)
    reading.error(axes[2].place,
                  fmt::format("{} parameters are scanned, but a grid has two at most", axes.size()),
                  "scan fewer, and set the others with --set");
  if (axes.size() != 2) return;
  if (names_overlap(axes[0].parameter, axes[1].parameter)) {
    const bool same = axes[0].parameter == axes[1].parameter;
    const Axis& inner = axes[1];
    reading.error(inner.place,
                  same ? fmt::format("`{}` is scanned twice", inner.parameter)
                       : fmt::format("`{}` and `{}` cannot be scanned together: one is a part of the other",
                                     axes[0].parameter, inner.parameter),
                  same ? "join the values in one scan" : "write the combinations as `values` of the whole");
  }
  const double total =
      static_cast<double>(axes[0].values.size()) * static_cast<double>(axes[1].values.size());
  if (total > max_scan_points)
    reading.error(axes[1].place, fmt::format("the grid has {} points, more than {}", total, max_scan_points),
                  "scan fewer points");
}

}  // namespace

ScanPlan read_scan(const Node& root, const std::vector<std::shared_ptr<const SourceText>>& arguments,
                   Reading& reading) {
  ScanPlan plan;
  const std::size_t errors = reading.errors.size();
  if (const Entry* scan = root.find("scan")) {
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
    const auto same = std::find_if(plan.axes.begin(), plan.axes.end(), [&](const Axis& a) {
      return !a.parameter.empty() && a.parameter == axis.parameter;
    });
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
