#pragma once
// From a beamline file and the command line to a checked experiment.
#include <string>
#include <vector>

#include "beamline/experiment.hpp"
#include "core/diagnostics.hpp"
#include "input/file.hpp"
#include "input/places.hpp"
#include "scan/settings.hpp"

namespace rabiline {

struct LoadedExperiment {
  Experiment experiment;
  std::vector<InputText> inputs;     // the file and what it includes, for provenance
  Beamline base;                     // the file's own values, with --set and without the scan
  Places places;                     // of all that the file states and --set changes
  std::vector<Diagnostic> unused{};  // warnings of variables
};

/// Reads, checks and expands the scan: every point is the file with the scanned values in place, read through
/// the same tables and checks. Throws InputError with everything that is wrong; a model is refused.
LoadedExperiment load_experiment(LoadedFile, const Changes&);

}  // namespace rabiline
