#pragma once
// From a beamline file and the command line to a checked experiment.
#include <filesystem>
#include <string>
#include <vector>

#include "beamline/beamline.hpp"
#include "core/diagnostics.hpp"
#include "input/file.hpp"
#include "input/places.hpp"
#include "input/settings.hpp"
#include "simulation/result.hpp"

namespace rabiline {

struct LoadedExperiment {
  Experiment experiment;
  std::vector<InputText> inputs;  // the file and what it includes, for provenance
  Beamline base;                  // the file's own values, with --set and without the scan
  Places places;                  // of all that the file states and --set changes
};

/// Reads, checks and expands the scan: every point is the file with the scanned values in place, read through
/// the same tables and checks. `folder` is where paths in the file begin. Throws InputError with everything
/// that is wrong.
LoadedExperiment load_experiment(LoadedFile, const std::string& folder, const CommandLine&);
/// The same from the disk; a file that is no beamline is refused.
LoadedExperiment load_experiment(const std::filesystem::path&, const CommandLine&);

}  // namespace rabiline
