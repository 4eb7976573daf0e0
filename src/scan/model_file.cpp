#include "scan/model_file.hpp"

#include <fmt/format.h>

#include "input/beamline_reader.hpp"
#include "input/places.hpp"
#include "input/reader.hpp"
#include "scan/dotted_name.hpp"
#include "scan/parameter_space.hpp"

namespace rabiline {
namespace {

// Of all scan points together: a GiB. What is written of a point besides takes as much as so many samples.
constexpr double most_samples = 1e6, samples_of_a_point = 200;

std::vector<Fault> faults_in(const ModelFile& file) {
  return std::visit([](const auto& any) { return faults_of(any); }, file.model);
}

ModelFile read_model_values(const Node& root, Reading& reading) {
  ModelFile out;
  Keys keys(root, "the file of a model", root.place, reading);
  check_version(root, keys);
  read_rows(keys, out);
  for (const std::string_view key : {"variables", "scan"}) keys.take(key);
  keys.finish([](std::string_view key) {
    const bool is_of_a_beamline = has_key<Beamline>(key) || key == "geometry";
    return std::vector<std::string>(is_of_a_beamline ? 1 : 0, "a beamline");
  });
  return out;
}

ModelFile read_model(const Node& root, Reading& reading) {
  const std::size_t errors = reading.errors.size();
  ModelFile out = read_model_values(root, reading);
  if (reading.errors.size() > errors) return out;
  const Places places(root);
  for (const Fault& fault : faults_in(out)) reading.errors.push_back(places.locate(fault));
  return out;
}

void apply_settings(Node& root, const std::vector<Setting>& settings, Reading& reading) {
  for (const Setting& s : settings) {
    if (s.name.empty()) continue;
    if (s.name == "particles" || s.name == "seed" || s.name == "scan.particles")
      reading.error(s.place, fmt::format("`{}` has no meaning for a model: it is solved, not flown", s.name),
                    "omit it");
    else
      put_value(root, s.name, s.place, s.value, reading);
  }
}

void check_scan(const Node* root, const ScanPlan& plan, Reading& reading) {
  if (plan.axes.size() > 1)
    reading.error(plan.axes[1].place, "a model is scanned over one parameter",
                  "set the other one with --set");
  for (const Axis& axis : plan.axes)
    for (const NamedAt& scanned : axis.parameters)
      if (!scanned.name.starts_with("model") && !scanned.name.starts_with("variables."))
        reading.error(scanned.place,
                      fmt::format("`{}` cannot be scanned: it is not a parameter of the model", scanned.name),
                      "scan one such as `model.samples`");
  const Entry* scan = root ? root->find("scan") : nullptr;
  if (!scan) return;
  const std::vector<Node> one{scan->value};
  for (const Node& node : scan->value.is_sequence() ? scan->value.items : one)
    if (const Entry* particles = node.find("particles"))
      reading.error(particles->key_place, "`particles` has no meaning for a model: it is solved, not flown",
                    "omit it");
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

LoadedModel load_model(LoadedFile file, const Changes& changes) {
  LoadedModel out;
  out.inputs = std::move(file.inputs);
  Reading reading;
  Sources& sources = file.sources;
  const std::vector<Setting> settings = read_settings(changes, sources, reading);
  apply_settings(file.root, settings, reading);
  Node with_values = file.root;
  if (!put_variables(with_values, reading)) throw_if_wrong(reading, sources);
  out.points = {read_model(with_values, reading)};
  const Sources arguments = scan_arguments(changes, sources);
  const Node* scanned = changes.without_scan ? nullptr : &with_values;
  const ScanPlan plan = read_scan(scanned, arguments, reading);
  check_scan(scanned, plan, reading);
  refuse_settings_of_scanned(settings, plan, reading);
  throw_if_wrong(reading, sources);
  if (plan.axes.empty()) return out;
  ParameterSpace<ModelFile> space(scans_variables(plan) ? file.root : with_values, scans_variables(plan),
                                  plan.axes,
                                  {&read_model, &read_model_values, [](ModelFile&) {},
                                   [](const ModelFile& model) { return faults_in(model).empty(); }},
                                  reading);
  out.axes = space.read(reading);
  throw_if_wrong(reading, sources);
  out.points.clear();
  for (std::size_t i = 0; i < space.size(); ++i) out.points.push_back(space.at(i));
  check_size(out, plan, reading);
  throw_if_wrong(reading, sources);
  return out;
}

}  // namespace

Loaded load_any(LoadedFile file, const Changes& changes) {
  if (file.root.find("model")) return load_model(std::move(file), changes);
  return load_experiment(std::move(file), changes);
}

}  // namespace rabiline
