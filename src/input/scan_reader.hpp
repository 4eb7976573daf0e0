#pragma once
// A file at each point of its scan: the scanned values put in its tree, and the tree read anew.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "input/dotted_name.hpp"
#include "input/scan.hpp"
#include "rules/rules.hpp"

namespace rabiline {

/// Reads a file at points of its scan, each by the same tables and checks.
template <class Point>
class ScanReader {
 public:
  using Read = Point (*)(const Node& root, Reading&);
  ScanReader(const Node& root, const ScanPlan& plan, Read read, Reading& reading)
      : root_(root), plan_(plan), read_(read), reading_(reading) {}

  /// Every value of each axis with the others as in the file: gives the axes, and the points where there is
  /// one. All values of a list are read to the end; of a range the first bad point tells enough.
  ScanAxis read_axis(const Axis& axis, std::vector<Point>& points) {
    ScanAxis out;
    out.parameter = axis.parameter;
    Node tree = root_;
    Node* node = put_value(tree, axis.parameter, axis.place, axis.values.front(), reading_);
    if (!node) return out;
    bool numeric = true;
    std::size_t failures = 0;
    for (std::size_t i = 0; i < axis.values.size() && failures < (axis.is_range ? 1 : 10); ++i) {
      *node = axis.values[i];
      reading_.watched = {{node, std::nullopt, 0}};
      const std::size_t errors = reading_.errors.size();
      Point point = read_(tree, reading_);
      name_point(errors, {{&axis, &axis.values[i]}});
      if (reading_.errors.size() > errors) ++failures;
      numeric = numeric && reading_.watched.front().dimension.has_value();
      if (numeric && i > 0 && out.dimension != reading_.watched.front().dimension)
        reading_.error(axis.values[i].place,
                       fmt::format("the scan of `{}` begins with {} and goes on with {}", axis.parameter,
                                   with_article(name_of(*out.dimension)),
                                   with_article(name_of(*reading_.watched.front().dimension))),
                       "write all its values in units of the same kind");
      if (i == 0) out.dimension = reading_.watched.front().dimension;
      out.values.push_back(reading_.watched.front().value);
      out.labels.push_back(label_of(axis, point, i));
      points.push_back(std::move(point));
    }
    reading_.watched.clear();
    if constexpr (std::is_same_v<Point, Beamline>)
      if (reading_.errors.empty())
        if (std::optional<Fault> fault = fault_of_axis(axis.parameter, points))
          reading_.error(axis.place, std::move(fault->message), std::move(fault->help));
    finish_axis(axis, numeric, out);
    return out;
  }

  std::vector<Point> read_grid() {
    std::vector<Point> points;
    Node tree = root_;
    const Axis &outer = plan_.axes[0], &inner = plan_.axes[1];
    // The second round finds every key in place, so that no pointer moves.
    Node *a = nullptr, *b = nullptr;
    for (int round = 0; round < 2; ++round) {
      a = put_value(tree, outer.parameter, outer.place, outer.values.front(), reading_);
      b = put_value(tree, inner.parameter, inner.place, inner.values.front(), reading_);
    }
    if (!a || !b) return points;
    points.reserve(outer.values.size() * inner.values.size());
    for (const Node& value : outer.values) {
      *a = value;
      for (const Node& other : inner.values) {
        *b = other;
        points.push_back(read_(tree, reading_));
        if (reading_.errors.empty()) continue;
        name_point(0, {{&outer, &value}, {&inner, &other}});
        return points;
      }
    }
    return points;
  }

 private:
  /// Says at which point of the scan something is wrong, where the place does not show it.
  void name_point(std::size_t from, const std::vector<std::pair<const Axis*, const Node*>>& values) {
    std::string where;
    for (const auto& [axis, value] : values)
      where += fmt::format("{}{} = {}", where.empty() ? "" : ", ", axis->parameter, to_text(*value));
    for (std::size_t i = from; i < reading_.errors.size(); ++i) {
      const Place& place = reading_.errors[i].place;
      const bool shown = std::any_of(values.begin(), values.end(), [&](const auto& v) {
        return place.text == v.first->place.text && place.line == v.first->place.line;
      });
      if (!shown) reading_.errors[i].message += fmt::format(" [at the scan point {}]", where);
    }
  }

  static std::string label_of(const Axis& axis, const Point& point, std::size_t i) {
    if constexpr (requires { point.law; })
      if (axis.parameter == "law") return describe(point.law);
    return to_text(axis.values[i]);
  }

  void finish_axis(const Axis& axis, bool numeric, ScanAxis& out) {
    std::set<double> numbers;
    std::set<std::string> words;
    for (std::size_t i = 0; i < out.values.size() && reading_.errors.empty(); ++i)
      if (!(numeric ? numbers.insert(out.values[i]).second : words.insert(out.labels[i]).second))
        reading_.error(axis.values[i].place, fmt::format("the scan has the value `{}` twice", out.labels[i]),
                       "keep one of them");
    if (numeric) {
      out.labels.clear();
      return;
    }
    out.dimension.reset();
    for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] = static_cast<double>(i);
  }

  const Node& root_;
  const ScanPlan& plan_;
  Read read_;
  Reading& reading_;
};

}  // namespace rabiline
