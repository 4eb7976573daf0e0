#include "input/experiment.hpp"

#include "input/beamline_reader.hpp"
#include "input/dotted_name.hpp"
#include "input/reader.hpp"
#include "input/scan.hpp"
#include "input/scan_reader.hpp"

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

LoadedExperiment load_experiment(LoadedFile file, const std::string& folder, const CommandLine& line) {
  LoadedExperiment out;
  out.inputs = std::move(file.inputs);
  Reading reading;
  reading.folder = folder;
  Sources& sources = file.sources;

  // The file with what the command line sets, without its scan.
  const std::vector<Setting> settings = read_settings(line, sources, reading);
  std::optional<ScanParticles> mode;
  if (file.root.is_mapping()) apply_settings(file.root, settings, reading, mode);
  out.base = read_beamline(file.root, reading);
  out.places = Places(file.root);

  // What is scanned.
  const Sources arguments = scan_arguments(line, sources);
  const ScanPlan plan = line.without_scan ? ScanPlan{} : read_scan(file.root, arguments, reading);
  refuse_settings_of_scanned(settings, plan, reading);
  add_files(reading, out.inputs, sources);
  throw_if_wrong(reading, sources);

  // Every point of the scan.
  ScanReader<Beamline> scan(file.root, plan, &read_beamline, reading);
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

LoadedExperiment load_experiment(const std::filesystem::path& path, const CommandLine& line) {
  LoadedFile file = load_file(path);
  if (const Entry* model = file.root.find("model"))
    throw InputError({{model->key_place, "this file describes a model, which has no beam and no particles",
                       "solve it with `rabiline run`"}});
  return load_experiment(std::move(file), path.parent_path().string(), line);
}

}  // namespace rabiline
