#pragma once
// What the verbs of the command line share: options of an experiment, exit codes, signals.
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/isa.hpp"
#include "input/model_file.hpp"
#include "plan/plan.hpp"
#include "simulation/snapshot.hpp"

namespace rabiline {

namespace exit_code {
inline constexpr int done = 0, bad_input = 2, not_written = 3, stopped = 4;
}

/// A mistake in the arguments: one line, exit code 2.
struct ArgumentError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// FILE and what changes its parameters.
struct ExperimentOptions {
  std::filesystem::path file;
  CommandLine changes;
  bool strict = false;  // warnings are errors
  void add_to(CLI::App&);
  void add_without_scan_to(CLI::App&);  // for one point: the file's own values
};

/// How to compute, which never changes a result.
struct MachineOptions {
  std::string threads;  // empty: as many as the process may use
  std::string isa;      // empty: the best one
  void add_to(CLI::App&);
  int thread_count() const;
  Isa instruction_set() const;  // throws ArgumentError
};

/// Set by SIGINT and SIGTERM after watch_signals().
const std::atomic<bool>& stop_requested();
void watch_signals();

/// Prints what is warned of, each with its line, and returns the texts. Where warnings are errors they are
/// thrown as such.
std::vector<std::string> report_warnings(const Experiment&, const Plan&, const Places&, bool strict,
                                         FILE* to);

/// Results never replace what they are computed from. Throws ArgumentError.
void require_no_input(const std::filesystem::path& output, const std::vector<InputText>& inputs);

/// This moment as ISO 8601 with offset, for provenance.
std::string now();
/// What is known of a run before it starts: program, machine, command line and inputs.
Provenance provenance_of(const std::vector<std::string>& arguments, const std::vector<InputText>& inputs);

/// Identifies an experiment with its changes: a checkpoint of another one is refused.
std::string fingerprint(const LoadedExperiment&, const CommandLine&);

/// Each verb adds itself to the command line; `exit` gets its exit code when it has run.
void add_run(CLI::App&, const std::vector<std::string>& arguments, const Snapshot* start, int& exit);
void add_check(CLI::App&);
void add_describe(CLI::App&);
void add_trace(CLI::App&);
void add_resume(CLI::App&, int& exit);

/// What `check` and `run` do for a model.
std::string check_model(const LoadedModel&);
void run_model(const LoadedModel&, const std::filesystem::path& output,
               const std::vector<std::string>& arguments);

/// The whole program: parses the arguments (without the program's name), runs the verb, explains what went
/// wrong.
int run_program(const std::vector<std::string>& arguments, const Snapshot* start = nullptr);

}  // namespace rabiline
