#include "scan/resolved.hpp"

#include <fmt/format.h>

#include <concepts>
#include <limits>
#include <map>
#include <utility>

#include "input/beamline_reader.hpp"
#include "input/tables.hpp"

namespace rabiline {
namespace {

/// A number, or a word.
struct Leaf {
  std::string name;
  Dimension dimension = Dimension::number;
  double value = std::numeric_limits<double>::quiet_NaN();
  std::string word{};
  bool same_as(double number, const std::string& text) const {
    return word == text && (value == number || (value != value && number != number));
  }
};

/// What the tables lead to, in their order.
class Leaves {
 public:
  std::vector<Leaf> list;

  void number(const std::string& name, double value, Dimension dimension = Dimension::number) {
    list.push_back({name, dimension, value});
  }
  void word(const std::string& name, std::string_view text) {
    list.push_back({name, Dimension::number, std::numeric_limits<double>::quiet_NaN(), std::string(text)});
  }

  template <class T>
  void add(const std::string& name, const T& value, Dimension dimension = Dimension::number) {
    if constexpr (is_optional<T>) {
      if (value) add(name, *value, dimension);
    } else if constexpr (is_variant<T>) {
      std::visit(
          [&](const auto& any) {
            if (!tag_key<T>.empty()) word(joined(name, tag_key<T>), any.kind);
            add(name, any);
          },
          value);
    } else if constexpr (is_list<T>) {
      for (std::size_t i = 0; i < value.size(); ++i) add(fmt::format("{}.{}", name, i), value[i], dimension);
    } else if constexpr (std::same_as<T, bool>) {
      word(name, value ? "true" : "false");
    } else if constexpr (std::is_arithmetic_v<T>) {
      number(name, static_cast<double>(value), dimension);
    } else if constexpr (std::same_as<T, std::string>) {
      word(name, value);
    } else if constexpr (std::same_as<T, SpeedQuantity> || std::same_as<T, ScannedQuantity>) {
      number(name, value.value, value.dimension);
    } else if constexpr (std::same_as<T, HalfInteger>) {
      number(name, value.value());
    } else if constexpr (std::same_as<T, AxisEnd>) {
      number(name, value.value);
    } else if constexpr (std::same_as<T, Phase>) {
      if (value.kind == Phase::Kind::angle)
        number(name, value.angle, Dimension::angle);
      else
        word(name, value.kind == Phase::Kind::random ? "random" : "locked");
    } else if constexpr (std::same_as<T, UnitVector> || std::same_as<T, Vector3>) {
      number(name + ".x", value.x);
      number(name + ".y", value.y);
      number(name + ".z", value.z);
    } else if constexpr (std::same_as<T, Bins>) {
      number(name + ".x", static_cast<double>(value.x));
      number(name + ".z", static_cast<double>(value.z));
    } else if constexpr (std::is_enum_v<T>) {
      for (const auto& choice : choices<T>)
        if (choice.value == value) word(name, choice.word);
    } else if constexpr (has_table<T>) {
      for_each_row<T>([&](const auto& row) { add(joined(name, row.key), value.*row.member, row.dimension); });
    }  // else a table of numbers from a file, whose text is among the inputs
  }

  void add(const std::string& name, const std::vector<Component>& components, Dimension) {
    for (std::size_t i = 0; i < components.size(); ++i) {
      const std::string here = components.size() == 1 ? name : fmt::format("{}.{}", name, i);
      const Species& species = components[i].species;
      word(here + ".name", species.name);
      number(here + ".fraction", components[i].fraction);
      number(here + ".mass", species.mass, Dimension::mass);
      number(here + ".charge", species.charge, Dimension::charge);
      number(here + ".spin", species.spin.value());
      number(here + ".gyromagnetic_ratio", species.gyromagnetic_ratio, Dimension::gyromagnetic);
      add(here + ".structure", species.structure);
    }
  }
  void add(const std::string& /*key*/, const std::vector<PlacedPart>& parts, Dimension) {
    for (const PlacedPart& part : parts) {
      add(part.placement.name, part.placement);
      add(part.placement.name, part.part);
    }
  }

 private:
  static std::string joined(const std::string& name, std::string_view key) {
    return key.empty() ? name : name.empty() ? std::string(key) : fmt::format("{}.{}", name, key);
  }
};

template <class File>
std::vector<Leaf> leaves_of(const File& file) {
  Leaves leaves;
  leaves.add("", file);
  return std::move(leaves.list);
}

/// Of a beamline or a model at each point.
template <class Points>
std::vector<ResolvedParameter> resolved(const Points& points) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<ResolvedParameter> out;
  std::map<std::string, std::size_t> columns;  // where a name is not where it was at the first point
  const auto put = [&](ResolvedParameter& column, std::size_t point, const Leaf& leaf) {
    if (column.values.size() == 1 && leaf.same_as(column.values[0], column.words[0])) return;
    column.values.resize(points.size(), column.values[0]);
    column.values[point] = leaf.value;
    if (column.words.size() == 1 && leaf.word == column.words[0]) return;
    column.words.resize(points.size(), column.words[0]);
    column.words[point] = leaf.word;
  };
  for (std::size_t point = 0; point < points.size(); ++point) {
    const std::vector<Leaf> leaves = leaves_of(points[point]);
    std::vector<bool> seen(out.size());
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      std::size_t at = i;
      if (point == 0 || at >= out.size() || out[at].name != leaves[i].name) {
        const auto [found, is_new] = columns.emplace(leaves[i].name, out.size());
        at = found->second;
        if (is_new && point == 0) {
          out.push_back({leaves[i].name,
                         std::string(si_unit_of(leaves[i].dimension)),
                         {leaves[i].value},
                         {leaves[i].word}});
        } else if (is_new) {
          out.push_back({leaves[i].name, std::string(si_unit_of(leaves[i].dimension)), {none}, {""}});
        }
        seen.resize(out.size());
      }
      put(out[at], point, leaves[i]);
      seen[at] = true;
    }
    for (std::size_t at = 0; at < out.size(); ++at)
      if (!seen[at]) put(out[at], point, {{}, Dimension::number, none, {}});
  }
  return out;
}

}  // namespace

std::vector<ResolvedParameter> resolved_parameters(const ScanPoints& points) { return resolved(points); }
std::vector<ResolvedParameter> resolved_parameters(const std::vector<ModelFile>& points) {
  return resolved(points);
}

}  // namespace rabiline
