#include "input/model_file.hpp"

#include <fmt/format.h>

#include "input/beamline_reader.hpp"
#include "input/dotted_name.hpp"
#include "input/places.hpp"
#include "input/reader.hpp"
#include "input/scan_reader.hpp"

namespace rabiline {
namespace {

// Of all scan points together: a GiB. What is written of a point besides takes as much as so many samples.
constexpr double most_samples = 1e6, samples_of_a_point = 200;

ModelFile read_model(const Node& root, Reading& reading) {
  ModelFile out;
  Keys keys(root, "the file of a model", root.place, reading);
  check_version(root, keys);
  const bool good = read_rows(keys, out);
  keys.take("scan");
  keys.finish([](std::string_view key) {
    return has_key<Beamline>(key) || key == "geometry" ? std::string("a beamline") : std::string{};
  });
  if (!good) return out;
  const Places places(root);
  for (const Fault& fault : std::visit([](const auto& any) { return faults_of(any); }, out.model))
    reading.errors.push_back(places.locate(fault));
  return out;
}

void apply_settings(Node& root, const std::vector<Setting>& settings, Reading& reading) {
  for (const Setting& s : settings) {
    if (s.name.empty()) continue;
    if (s.name == "particles" || s.name == "seed" || s.name == "scan.particles")
      reading.error(s.place, fmt::format("`{}` has no meaning for a model: it is solved, not flown", s.name),
                    "leave it away");
    else
      put_value(root, s.name, s.place, s.value, reading);
  }
}

void check_scan(const Node& root, const ScanPlan& plan, Reading& reading) {
  if (plan.axes.size() > 1)
    reading.error(plan.axes[1].place, "a model is scanned over one parameter",
                  "set the other one with --set");
  for (const auto& axis : plan.axes)
    if (!axis.parameter.starts_with("model"))
      reading.error(axis.place,
                    fmt::format("`{}` cannot be scanned: it is no parameter of the model", axis.parameter),
                    "scan one such as `model.samples`");
  const Entry* scan = root.find("scan");
  if (!scan) return;
  const std::vector<Node> one{scan->value};
  for (const Node& node : scan->value.is_sequence() ? scan->value.items : one)
    if (const Entry* particles = node.find("particles"))
      reading.error(particles->key_place, "`particles` has no meaning for a model: it is solved, not flown",
                    "leave it away");
}

/// Every point keeps its motions until all are written.
void check_size(const LoadedModel& loaded, const ScanPlan& plan, Reading& reading) {
  double samples = samples_of_a_point * static_cast<double>(loaded.points.size());
  for (const ModelFile& point : loaded.points)
    samples += std::visit([](const auto& any) { return static_cast<double>(any.samples); }, point.model);
  if (samples > most_samples)
    reading.error(plan.axes.front().place,
                  fmt::format("the scan has {} points with {:.0f} samples in all, more than fit into a file",
                              loaded.points.size(),
                              samples - samples_of_a_point * static_cast<double>(loaded.points.size())),
                  "take fewer `samples` or fewer points");
}

LoadedModel load_model(LoadedFile file, const CommandLine& line) {
  LoadedModel out;
  out.inputs = std::move(file.inputs);
  Reading reading;
  Sources& sources = file.sources;
  const std::vector<Setting> settings = read_settings(line, sources, reading);
  apply_settings(file.root, settings, reading);
  out.points = {read_model(file.root, reading)};
  const Sources arguments = scan_arguments(line, sources);
  const ScanPlan plan = read_scan(file.root, arguments, reading);
  check_scan(file.root, plan, reading);
  refuse_settings_of_scanned(settings, plan, reading);
  throw_if_wrong(reading, sources);
  if (plan.axes.empty()) return out;
  out.points.clear();
  ScanReader<ModelFile> scan(file.root, plan, &read_model, reading);
  out.axes.push_back(scan.read_axis(plan.axes.front(), out.points));
  if (reading.errors.empty()) check_size(out, plan, reading);
  throw_if_wrong(reading, sources);
  return out;
}

}  // namespace

Loaded load(const std::filesystem::path& path, const CommandLine& line) {
  LoadedFile file = load_file(path);
  if (file.root.find("model")) return load_model(std::move(file), line);
  return load_experiment(std::move(file), path.parent_path().string(), line);
}

}  // namespace rabiline
