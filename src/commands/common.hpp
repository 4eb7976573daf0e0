#pragma once
// What the verbs of the command line share: options of an experiment, exit codes.
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "commands/say.hpp"
#include "rabiline.hpp"

namespace rabiline {

namespace exit_code {
inline constexpr int done = 0, mistake = 1, bad_input = 2, not_written = 3, stopped = 4;
}

/// A mistake in the arguments: one line, exit code 2.
struct ArgumentError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// FILE and what changes its parameters.
struct ExperimentOptions {
  std::filesystem::path file;
  Changes changes;
  bool strict = false;  // warnings are errors
  void add_to(CLI::App&);
  void add_without_scan_to(CLI::App&);  // for one point: the file's own values
};

/// --set; --scan and --no-scan.
void add_changes_to(CLI::App&, Changes&);
void add_scan_to(CLI::App&, Changes&);

/// How to compute, which never changes a result.
struct MachineOptions {
  std::string threads;     // empty: as many as the process may use
  std::string isa;         // empty: the best one
  std::string max_memory;  // empty: not stated
  void add_to(CLI::App&);
  void add_isa_to(CLI::App&);
  void add_memory_to(CLI::App&);
  /// Throws ArgumentError and InputError.
  RunSettings settings() const;
};

/// Prints what is warned of, each with its line. Where warnings are errors they are thrown as such.
void tell(std::vector<Diagnostic> warnings, bool strict, FILE* to);

/// Calls the library; what it says of a value is told with the option that gave it.
template <class Call>
auto blaming(const char* option, Call call) {
  try {
    return call();
  } catch (const std::invalid_argument& error) {
    throw ArgumentError(fmt::format("{}: {}", option, error.what()));
  }
}

/// "A clock: ", or nothing where there is no title.
std::string headed(const std::string& title);

/// `note`: a line of its own, or nothing.
void print_summary(const Result&, const std::filesystem::path& output, std::string_view note = {});

/// Before anything is computed: results never replace what they are computed from, and must find their place.
/// Throws ArgumentError and StorageError.
void require_place(const std::filesystem::path& output, const std::vector<InputText>& inputs);
/// The inputs of an experiment and the file that it was loaded from, which may be a result.
std::vector<InputText> with_file(std::vector<InputText> inputs, const std::filesystem::path& file);

/// Calls it; what went wrong is told, and its exit code returned.
int explained(const std::function<int()>& call);

/// Each verb adds itself to the command line; `exit` gets its exit code when it has run. `ranks` fly along
/// where there are any.
void add_run(CLI::App&, const std::vector<std::string>& arguments, Ranks* ranks, int& exit);
void add_check(CLI::App&, int& exit);
void add_describe(CLI::App&);
void add_trace(CLI::App&);
void add_probe(CLI::App&);
void add_resume(CLI::App&, Ranks* ranks, int& exit);
void add_merge(CLI::App&, Ranks* ranks, int& exit);
void add_verify(CLI::App&, int& exit);
void add_reproduce(CLI::App&, Ranks* ranks, int& exit);
void add_rescan(CLI::App&, const std::vector<std::string>& arguments, int& exit);

struct FlightOptions;
/// What the Python package does: plots, summaries, fits. Their verbs, for help and spelling.
void add_package_verbs(CLI::App&);
bool is_of_the_package(const std::string& verb);
/// Becomes the package's command line. Throws ArgumentError where there is no package.
[[noreturn]] void start_package(const std::vector<std::string>& arguments);

/// What `run` does for a model.
void run_model(const Setup&, const std::filesystem::path& output, const FlightOptions&,
               const std::vector<std::string>& arguments);

/// The whole program: parses the arguments (without the program's name), runs the verb, explains what went
/// wrong.
int run_program(const std::vector<std::string>& arguments);

}  // namespace rabiline
