#include "scan/experiment.hpp"

#include "input/beamline_reader.hpp"
#include "input/reader.hpp"
#include "rules/rules.hpp"
#include "scan/dotted_name.hpp"
#include "scan/parameter_space.hpp"
#include "scan/scan.hpp"

namespace rabiline {
namespace {

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

}  // namespace

LoadedExperiment load_experiment(LoadedFile file, const Changes& changes) {
  if (const Entry* model = file.root.find("model"))
    throw InputError({{model->key_place, "this file describes a model, which has no beam and no particles",
                       "solve it with `rabiline run`"}});
  LoadedExperiment out;
  out.inputs = std::move(file.inputs);
  Reading reading;
  reading.folder = file.folder;
  reading.stored = file.stored;
  Sources& sources = file.sources;

  // The file with what the command line sets, without its scan.
  const std::vector<Setting> settings = read_settings(changes, sources, reading);
  std::optional<ScanParticles> mode;
  if (file.root.is_mapping()) apply_settings(file.root, settings, reading, mode);
  out.unused = unused_variables(file.root);
  Node with_values = file.root;
  if (!put_variables(with_values, reading)) throw_if_wrong(reading, sources);
  out.base = read_beamline(with_values, reading);
  out.places = Places(with_values);

  // What is scanned.
  const Sources arguments = scan_arguments(changes, sources);
  const ScanPlan plan = read_scan(changes.without_scan ? nullptr : &with_values, arguments, reading);
  refuse_settings_of_scanned(settings, plan, reading);
  add_files(reading, out.inputs, sources);
  throw_if_wrong(reading, sources);

  // Every point of the scan.
  out.experiment.particles = mode.value_or(plan.particles);
  const auto require_scan = [&] {
    for (const Fault& fault : faults_of_scan(out.experiment))
      reading.errors.push_back(out.places.locate(fault));
    throw_if_wrong(reading, sources);
  };
  if (plan.axes.empty()) {
    out.experiment.points = {out.base};
    require_scan();
    return out;
  }
  const auto space = std::make_shared<ParameterSpace<Beamline>>(
      scans_variables(plan) ? file.root : with_values, scans_variables(plan), plan.axes,
      FileReader<Beamline>{&read_beamline, &read_beamline_values, &finish_beamline,
                           [](const Beamline& beamline) { return faults_of(beamline).empty(); }},
      reading);
  out.experiment.axes = space->read(reading);
  add_files(reading, out.inputs, sources);
  throw_if_wrong(reading, sources);
  out.experiment.points = {space->size(), [space](std::size_t point) { return space->at(point); }};
  require_scan();
  return out;
}

}  // namespace rabiline
