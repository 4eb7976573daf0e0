#include "input/experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>
#include <tuple>

#include "input/beamline_reader.hpp"
#include "input/checks.hpp"
#include "input/dotted_name.hpp"
#include "input/file.hpp"
#include "input/reader.hpp"
#include "input/scan.hpp"

namespace rabiline {
namespace {

using Sources = std::vector<std::shared_ptr<const SourceText>>;

/// Throws what was found, each problem once, in the order of the texts.
void throw_if_wrong(Reading& reading, const Sources& sources) {
  if (reading.errors.empty()) return;
  const auto key = [&](const Diagnostic& d) {
    const auto found = std::find(sources.begin(), sources.end(), d.place.text);
    return std::tuple(found - sources.begin(), d.place.line, d.place.column);
  };
  std::stable_sort(reading.errors.begin(), reading.errors.end(),
                   [&](const Diagnostic& a, const Diagnostic& b) { return key(a) < key(b); });
  const auto same = [&](const Diagnostic& a, const Diagnostic& b) {
    return key(a) == key(b) && a.message == b.message;
  };
  reading.errors.erase(std::unique(reading.errors.begin(), reading.errors.end(), same), reading.errors.end());
  throw InputError(std::move(reading.errors));
}

/// What the beamline files name beside themselves belongs to the inputs.
void add_files(const Reading& reading, std::vector<InputText>& inputs, Sources& sources) {
  for (const auto& [path, file] : reading.files) {
    if (std::find(sources.begin(), sources.end(), file.source) != sources.end()) continue;
    inputs.push_back({path, file.text});
    sources.push_back(file.source);
  }
}

/// One NAME=VALUE of the command line.
struct Setting {
  std::string name;
  Place place;
  Node value;
};

Setting read_setting(const std::shared_ptr<const SourceText>& source, Reading& reading) {
  const std::string& text = source->lines.front();
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    reading.error({source, 1, 1, std::max(1, static_cast<int>(text.size()))}, "a value is set as NAME=VALUE",
                  "such as `H0.amplitude=0.3 uT`");
    return {};
  }
  Node value = parse_value(source, equals + 1, text.size() - equals - 1);
  const std::string name = text.substr(0, equals);
  if (!value.is_null()) return {name, {source, 1, 1, static_cast<int>(equals)}, std::move(value)};
  reading.error({source, 1, static_cast<int>(equals) + 2, 1}, fmt::format("`{}` is set to nothing", name),
                "write the value after `=`");
  return {};
}

/// The settings of the command line, --particles and --seed among them.
std::vector<Setting> read_settings(const CommandLine& line, Sources& sources, Reading& reading) {
  std::vector<Setting> out;
  for (const std::string& text : line.set) {
    sources.push_back(make_source_text("--set", text));
    out.push_back(read_setting(sources.back(), reading));
  }
  const auto add_count = [&](const std::string& name, const std::optional<std::uint64_t>& value) {
    if (!value) return;
    sources.push_back(make_source_text("--" + name, std::to_string(*value)));
    const Place place{sources.back(), 1, 1, static_cast<int>(sources.back()->lines[0].size())};
    out.push_back({name, place, parse_value(sources.back(), 0, sources.back()->lines[0].size())});
  };
  add_count("particles", line.particles);
  add_count("seed", line.seed);
  return out;
}

/// Puts the settings into the tree; `scan.particles` is put into the scan of the file, or kept for that of
/// the command line.
void apply_settings(Node& root, const std::vector<Setting>& settings, Reading& reading,
                    std::optional<ScanParticles>& mode) {
  for (const Setting& s : settings) {
    if (s.name.empty()) continue;
    if (s.name == "scan.particles")
      read_value(s.value, s.place, {"scan.particles", Dimension::number, range::any, ""}, reading, mode);
    else
      put_value(root, s.name, s.place, s.value, reading);
  }
}

void refuse_settings_of_scanned(const std::vector<Setting>& settings, const ScanPlan& plan,
                                Reading& reading) {
  for (const Setting& s : settings)
    for (const Axis& axis : plan.axes)
      if (!axis.parameter.empty() && (s.name == axis.parameter || s.name.starts_with(axis.parameter + ".")))
        reading.error(s.place, fmt::format("`{}` is scanned, so it cannot be set as well", axis.parameter),
                      fmt::format("replace the scan: `--scan {}=...`", axis.parameter));
}

/// Reads the experiment at points of its scan.
class ScanReader {
 public:
  ScanReader(const Node& root, const ScanPlan& plan, Reading& reading)
      : root_(root), plan_(plan), reading_(reading) {}

  /// Every value of each axis with the others as in the file: gives the axes, and the points where there is
  /// one. All values of a list are read to the end; of a range the first bad point tells enough.
  ScanAxis read_axis(const Axis& axis, std::vector<Beamline>& points) {
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
      Beamline point = read_beamline(tree, reading_);
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
    if (reading_.errors.empty()) check_axis(axis, points, reading_);
    finish_axis(axis, numeric, out);
    return out;
  }

  std::vector<Beamline> read_grid() {
    std::vector<Beamline> points;
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
        points.push_back(read_beamline(tree, reading_));
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

  static std::string label_of(const Axis& axis, const Beamline& point, std::size_t i) {
    return axis.parameter == "law" ? describe(point.law) : to_text(axis.values[i]);
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
  Reading& reading_;
};

}  // namespace

LoadedExperiment load_experiment(const std::filesystem::path& path, const CommandLine& line) {
  LoadedFile file = load_file(path);
  LoadedExperiment out;
  out.inputs = std::move(file.inputs);
  Reading reading;
  reading.folder = path.parent_path().string();
  Sources& sources = file.sources;

  // The file with what the command line sets, without its scan.
  const std::vector<Setting> settings = read_settings(line, sources, reading);
  std::optional<ScanParticles> mode;
  if (file.root.is_mapping()) apply_settings(file.root, settings, reading, mode);
  out.base = read_beamline(file.root, reading);

  // What is scanned.
  Sources arguments;
  for (const std::string& text : line.scan) arguments.push_back(make_source_text("--scan", text));
  sources.insert(sources.end(), arguments.begin(), arguments.end());
  const ScanPlan plan = line.without_scan ? ScanPlan{} : read_scan(file.root, arguments, reading);
  refuse_settings_of_scanned(settings, plan, reading);
  add_files(reading, out.inputs, sources);
  throw_if_wrong(reading, sources);

  // Every point of the scan.
  ScanReader scan(file.root, plan, reading);
  out.experiment.particles = mode.value_or(plan.particles);
  for (const Axis& axis : plan.axes) {
    out.experiment.points.clear();
    out.experiment.axes.push_back(scan.read_axis(axis, out.experiment.points));
  }
  add_files(reading, out.inputs, sources);
  throw_if_wrong(reading, sources);
  if (plan.axes.size() == 2) out.experiment.points = scan.read_grid();
  if (plan.axes.empty()) out.experiment.points = {out.base};
  throw_if_wrong(reading, sources);
  return out;
}

}  // namespace rabiline
