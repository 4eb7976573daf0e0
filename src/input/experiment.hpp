#pragma once
// From a YAML file and the command line to a checked experiment.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "beamline/beamline.hpp"
#include "core/diagnostics.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// What the command line changes in a file.
struct CommandLine {
  std::vector<std::string> set;   // NAME=VALUE
  std::vector<std::string> scan;  // NAME=FROM:TO:POINTS or NAME=A,B,C
  std::optional<std::uint64_t> particles, seed;
  bool without_scan = false;  // the file's scan is left out
};

struct LoadedExperiment {
  Experiment experiment;
  std::vector<InputText> inputs;  // the file and what it includes, for provenance
  Beamline base;                  // the file's own values, with --set and without the scan
};

/// Reads, checks and expands the scan: every point is the file with the scanned values in place, read through
/// the same tables and checks. Throws InputError with everything that is wrong.
LoadedExperiment load_experiment(const std::filesystem::path&, const CommandLine&);

}  // namespace rabiline
