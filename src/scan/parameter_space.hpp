#pragma once
// A file over its scan: any point is made on demand, at a cost that does not depend on how many there are.
#include <fmt/format.h>

#include <algorithm>
#include <any>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "beamline/experiment.hpp"
#include "core/spelling.hpp"
#include "input/beamline_reader.hpp"
#include "rules/rules.hpp"
#include "scan/dotted_name.hpp"
#include "scan/member.hpp"
#include "scan/scan.hpp"
#include "scan/variables.hpp"

namespace rabiline {

/// How a file is read. `values` by the tables alone; `finish` makes of that what flies; `is_sound` asks the
/// rules. `read` does it all, and reports what is wrong.
template <class File>
struct FileReader {
  File (*read)(const Node& root, Reading&);
  File (*values)(const Node& root, Reading&);
  void (*finish)(File&);
  bool (*is_sound)(const File&);
};

/// The values of the axes, and the file that they are put into. Where the tables lead to every scanned
/// parameter, its values are read once and put into the typed file; else (`species.mass`, a variable, the
/// kind of a part) they are put into the tree, which is read again.
template <class File>
class ParameterSpace {
 public:
  /// `root` has its settings. `open_variables`: some are scanned, so that each point puts them in place anew.
  ParameterSpace(const Node& root, bool open_variables, std::vector<Axis> axes, FileReader<File> reader,
                 const Reading& reading)
      : root_(root),
        open_variables_(open_variables),
        axes_(std::move(axes)),
        reader_(reader),
        files_(reading) {
    files_.errors.clear();
    files_.watched.clear();
  }

  std::size_t size() const {
    std::size_t size = 1;
    for (const Axis& axis : axes_) size *= axis.size();
    return size;
  }

  /// Reads every value of each axis with the others as in the file, and then asks the rules about every
  /// point. All values of a list are read to the end; of a range the first bad point tells enough.
  std::vector<ScanAxis> read(Reading& reading) {
    std::vector<ScanAxis> out;
    for (std::size_t k = 0; k < axes_.size(); ++k) {
      if (axes_.size() == 1) {
        prepare(reading);
        out.push_back(read_axis(*this, 0, reading));
      } else {
        ParameterSpace alone(root_, open_variables_, {axes_[k]}, reader_, reading);
        alone.prepare(reading);
        out.push_back(read_axis(alone, k, reading));
        values_.push_back(std::move(alone.values_.front()));
      }
    }
    if (!reading.errors.empty()) return out;
    if (axes_.size() > 1) {
      prepare(reading);
      ask_rules(reading);
    }
    files_.files = reading.files;
    return out;
  }

  /// The file at one point, the last axis changing fastest.
  File at(std::size_t point) const {
    File out;
    if (typed_) {
      out = origin_;
      for (std::size_t k = axes_.size(); k-- > 0; point /= axes_[k].size())
        put(k, point % axes_[k].size(), out);
    } else {
      Reading quiet = files_;
      out = reader_.values(tree_at(point), quiet);
    }
    reader_.finish(out);
    return out;
  }

 private:
  /// What is done to a member that a dotted name leads to. One visitor for all, since each is compiled for
  /// every parameter of every table.
  struct Access {
    enum class Deed { find, read, put } deed = Deed::find;
    const Node* node = nullptr;  // to read from
    const Place* named_at = nullptr;
    Reading* reading = nullptr;
    std::any value{};  // that was read, or is put
    bool good = false;
    template <class Row, class Member>
    void operator()(const Row& row, Member& member) {
      if (deed == Deed::read) {
        good = read_value(*node, *named_at, row_of(row), *reading, member);
        value = member;
      } else if (deed == Deed::put) {
        member = *std::any_cast<Member>(&value);
      }
    }
  };
  using Deed = typename Access::Deed;

  static std::vector<std::string> path_of(const std::string& name) {
    std::vector<std::string> out;
    for (std::size_t from = 0; from <= name.size();) {
      const std::size_t end = std::min(name.find('.', from), name.size());
      out.push_back(name.substr(from, end - from));
      from = end + 1;
    }
    return out;
  }

  /// Reads the file at the first value of each axis: every scanned key is there, and every optional member.
  void prepare(Reading& reading) {
    tree_ = root_;
    bool found = true;
    for (const Axis& axis : axes_)
      for (const NamedAt& named : axis.parameters)
        found = put_value(tree_, named.name, named.place, axis.value(0), reading) != nullptr && found;
    typed_ = false;
    if (!found) return;
    Reading quiet = files_;
    quiet.files = reading.files;
    origin_ = reader_.values(with_variables_in(tree_, quiet), quiet);
    typed_ = tables_suffice_ && quiet.errors.empty();
    paths_.clear();
    for (const Axis& axis : axes_) {
      auto& paths = paths_.emplace_back();
      for (const NamedAt& named : axis.parameters) {
        paths.push_back(path_of(named.name));
        Access find;
        typed_ = typed_ && visit_parameter(origin_, paths.back(), find);
      }
    }
  }

  void put(std::size_t axis, std::size_t i, File& out) const {
    for (std::size_t k = 0; k < paths_[axis].size(); ++k) {
      Access put{.deed = Deed::put, .value = values_[axis][i * paths_[axis].size() + k]};
      visit_parameter(out, paths_[axis][k], put);
    }
  }

  Node with_variables_in(Node tree, Reading& reading) const {
    if (open_variables_) put_variables(tree, reading);
    return tree;
  }
  Node tree_at(std::size_t point) const {
    Node tree = tree_;
    Reading quiet;
    for (std::size_t k = axes_.size(); k-- > 0; point /= axes_[k].size())
      for (const NamedAt& named : axes_[k].parameters)
        put_value(tree, named.name, named.place, axes_[k].value(point % axes_[k].size()), quiet);
    return with_variables_in(std::move(tree), quiet);
  }

  /// What a value of an axis was read as.
  struct Number {
    std::optional<Dimension> dimension;
    double value = 0;
  };

  /// Puts one value of the only axis into the typed file and asks the rules; nothing where the tree has to
  /// tell.
  std::optional<Number> read_typed(std::size_t i, const Reading& reading) {
    if (!typed_) return {};
    const Axis& axis = axes_.front();
    const Node node = axis.value(i);
    Reading quiet = files_;
    quiet.files = reading.files;
    quiet.watched = {{&node, std::nullopt, 0}};
    File file = origin_;
    for (std::size_t k = 0; k < axis.parameters.size(); ++k) {
      Access read{Deed::read, &node, &axis.parameters[k].place, &quiet};
      visit_parameter(file, paths_.front()[k], read);
      if (!read.good || node.is_null()) return {};
      values_.front().push_back(std::move(read.value));
    }
    files_.files = quiet.files;
    reader_.finish(file);
    if (!reader_.is_sound(file)) return {};
    return Number{quiet.watched.front().dimension, quiet.watched.front().value};
  }

  /// The same through the tree, where every fault finds its place.
  Number read_tree(std::size_t i, Reading& reading) {
    const Axis& axis = axes_.front();
    const Node value = axis.value(i);
    Node tree = tree_;
    reading.watched.clear();
    for (const NamedAt& named : axis.parameters)
      if (Node* node = put_value(tree, named.name, named.place, value, reading))
        reading.watched.push_back({node, std::nullopt, 0});
    if (open_variables_) {
      reader_.read(with_variables_in(std::move(tree), reading), reading);
      const ParsedQuantity parsed =
          value.is_scalar() ? parse_quantity(value.scalar) : ParsedQuantity{0, {}, "a list", {}};
      return parsed.error.empty() ? Number{parsed.dimension, parsed.value} : Number{};
    }
    reader_.read(tree, reading);
    return {reading.watched.front().dimension, reading.watched.front().value};
  }

  /// `alone` has that axis only.
  ScanAxis read_axis(ParameterSpace& alone, std::size_t number, Reading& reading) {
    const Axis& axis = axes_[number];
    ScanAxis out;
    out.parameter = axis.name();
    alone.values_.resize(1);
    if (!reading.errors.empty() && alone.paths_.empty()) return out;
    bool numeric = true;
    std::size_t failures = 0;
    for (std::size_t i = 0; i < axis.size() && failures < (axis.is_range() ? 1 : 10); ++i) {
      std::optional<Number> read = alone.read_typed(i, reading);
      if (!read) {
        const std::size_t errors = reading.errors.size();
        read = alone.read_tree(i, reading);
        name_point(errors, {{&axis, axis.value(i)}}, reading);
        if (reading.errors.size() > errors)
          ++failures;
        else
          alone.typed_ = tables_suffice_ = false;
      }
      numeric = numeric && read->dimension.has_value();
      if (numeric && i > 0 && out.dimension != read->dimension)
        reading.error(
            axis.value(i).place,
            fmt::format("the scan of `{}` begins with {} and goes on with {}", out.parameter,
                        with_article(name_of(*out.dimension)), with_article(name_of(*read->dimension))),
            "write all its values in units of the same kind");
      if (i == 0) out.dimension = read->dimension;
      out.values.push_back(read->value);
    }
    reading.watched.clear();
    if (reading.errors.empty()) {
      alone.files_.files = reading.files;
      check_axis(axis, alone, reading);
      finish_axis(axis, alone, numeric, out, reading);
    }
    return out;
  }

  /// What may not change along an axis.
  static void check_axis(const Axis& axis, const ParameterSpace& alone, Reading& reading) {
    if constexpr (std::is_same_v<File, Beamline>) {
      const ScanPoints points(alone.size(), [&](std::size_t i) { return alone.at(i); });
      if (std::optional<Fault> fault = fault_of_axis(axis.name(), points))
        reading.error(axis.place, std::move(fault->message), std::move(fault->help));
    }
  }

  /// Says at which point of the scan something is wrong, where the place does not show it.
  static void name_point(std::size_t from, const std::vector<std::pair<const Axis*, Node>>& values,
                         Reading& reading) {
    std::string where;
    for (const auto& [axis, value] : values)
      where += fmt::format("{}{} = {}", where.empty() ? "" : ", ", axis->name(), to_text(value));
    for (std::size_t i = from; i < reading.errors.size(); ++i) {
      const Place& place = reading.errors[i].place;
      const bool shown = std::any_of(values.begin(), values.end(), [&](const auto& v) {
        return place.text == v.first->place.text && place.line == v.first->place.line;
      });
      if (!shown) reading.errors[i].message += fmt::format(" [at the scan point {}]", where);
    }
  }

  /// Asks about every point of the grid; the first bad one is told.
  void ask_rules(Reading& reading) {
    for (std::size_t point = 0; point < size(); ++point) {
      if (typed_ && reader_.is_sound(at(point))) continue;
      reader_.read(tree_at(point), reading);
      if (reading.errors.empty()) continue;
      std::vector<std::pair<const Axis*, Node>> values;
      for (std::size_t k = axes_.size(), rest = point; k-- > 0; rest /= axes_[k].size())
        values.insert(values.begin(), {&axes_[k], axes_[k].value(rest % axes_[k].size())});
      return name_point(0, values, reading);
    }
  }

  static void finish_axis(const Axis& axis, const ParameterSpace& alone, bool numeric, ScanAxis& out,
                          Reading& reading) {
    if (!numeric) {
      out.dimension.reset();
      for (std::size_t i = 0; i < out.values.size(); ++i) {
        out.values[i] = static_cast<double>(i);
        out.labels.push_back(label_of(axis, alone, i));
      }
    }
    const std::size_t last = out.values.size() - 1;  // of a range, only both ends are as they were written
    if (numeric) out.unit = unit_in(axis.value(out.values.front() != 0 ? 0 : last).scalar);
    std::set<double> numbers;
    std::set<std::string> words;
    for (std::size_t i = 0; i < out.values.size(); ++i)
      if (!(numeric ? numbers.insert(out.values[i]).second : words.insert(out.labels[i]).second))
        reading.error(axis.value(i).place,
                      fmt::format("the scan has the value `{}` twice",
                                  numeric ? to_text(axis.value(i)) : out.labels[i]),
                      "keep one of them");
  }

  static std::string label_of(const Axis& axis, const ParameterSpace& alone, std::size_t i) {
    if constexpr (requires(const File& file) { file.law; })
      if (axis.name() == "law") return describe(alone.at(i).law);
    return to_text(axis.value(i));
  }

  Node root_, tree_;  // without and with the scanned keys
  bool open_variables_;
  std::vector<Axis> axes_;
  FileReader<File> reader_;
  Reading files_;  // what was read beside the file
  bool typed_ = false, tables_suffice_ = true;
  File origin_;                                               // at the first value of each axis, unfinished
  std::vector<std::vector<std::vector<std::string>>> paths_;  // [axes][parameters][words]
  std::vector<std::vector<std::any>> values_;                 // [axes][points * parameters]
};

}  // namespace rabiline
