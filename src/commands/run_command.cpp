// rabiline run: flies the experiment, or solves the model, and writes one HDF5 file.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>

#include <unistd.h>

#include "commands/common.hpp"
#include "input/settings.hpp"
#include "particle/batch.hpp"

namespace rabiline {
namespace {

struct RunArguments {
  ExperimentOptions experiment;
  MachineOptions machine;
  std::string output;
  std::string progress = "auto";
  std::string batch;  // empty: the largest
  std::string transit = "auto";
};

std::string duration(double seconds) {
  const long s = std::lround(seconds);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

/// Shows how far a run is: one line that renews itself on a terminal, a line every ten seconds elsewhere.
class ProgressLine {
 public:
  explicit ProgressLine(const std::string& kind)
      : terminal_(kind == "auto" && isatty(STDERR_FILENO) == 1),
        json_(kind == "json"),
        quiet_(kind == "none") {}

  void operator()(const Progress& p) {
    if (quiet_) return;
    if (terminal_) {
      fmt::print(stderr, "\r{:5.1f} %  {} left{}      ", 100 * p.done, duration(p.seconds_left), reached(p));
      shown_ = true;
      return;
    }
    if (p.seconds < next_) return;
    next_ = p.seconds + 10;
    if (json_)
      fmt::print(stderr,
                 "{{\"done\": {:.4f}, \"seconds\": {:.1f}, \"seconds_left\": {:.1f}, \"error\": {:.6g}}}\n",
                 p.done, p.seconds, p.seconds_left, p.error);
    else
      fmt::print(stderr, "{:5.1f} %  {} left{}\n", 100 * p.done, duration(p.seconds_left), reached(p));
  }
  void clear() const {
    if (shown_) fmt::print(stderr, "\r{:40}\r", "");
  }

 private:
  static std::string reached(const Progress& p) {
    return p.error > 0 ? fmt::format(" of a part; error of `detected` so far {:.2g}", p.error) : "";
  }

  bool terminal_, json_, quiet_, shown_ = false;
  double next_ = 0;
};

/// The command that goes on with this run from any folder.
std::vector<std::string> arguments_to_resume(const RunArguments& a, const std::filesystem::path& output) {
  std::vector<std::string> arguments{"run", std::filesystem::absolute(a.experiment.file).string(), "-o",
                                     std::filesystem::absolute(output).string()};
  const auto add = [&](const char* option, const std::string& value) {
    arguments.insert(arguments.end(), {option, value});
  };
  if (a.experiment.strict) arguments.push_back("--strict");
  const std::vector<std::string> changes = options_of(a.experiment.changes);
  arguments.insert(arguments.end(), changes.begin(), changes.end());
  if (!a.machine.threads.empty()) add("--threads", a.machine.threads);
  if (!a.machine.isa.empty()) add("--isa", a.machine.isa);
  if (!a.batch.empty()) add("--batch", a.batch);
  add("--progress", a.progress);
  add("--transit", a.transit);
  return arguments;
}

/// Writes checkpoints; one that cannot be written is worth a warning, not the run.
class Checkpoints {
 public:
  Checkpoints(std::filesystem::path path, std::vector<std::string> arguments)
      : path_(std::move(path)), arguments_(std::move(arguments)) {}

  void write_or_warn(Snapshot snapshot) const {
    snapshot.arguments = arguments_;
    try {
      write(snapshot, path_);
    } catch (const StorageError& error) {
      if (stop_requested()) throw;
      fmt::print(stderr, "\nwarning: {}\n", error.what());
    }
  }
  void remove() const {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }

 private:
  std::filesystem::path path_;
  std::vector<std::string> arguments_;
};

/// What has a meaning for particles alone.
void refuse_for_a_model(const CLI::App& verb) {
  for (const char* option : {"--threads", "--isa", "--batch", "--progress", "--transit"})
    if (verb.count(option) > 0)
      throw ArgumentError(
          fmt::format("{} has no meaning for a model: it is solved, not flown\n  help: omit it", option));
}

RunSettings settings_of(const RunArguments& a) {
  RunSettings settings = a.machine.settings();
  settings.transit = a.transit == "none"     ? KeptTransit::none
                     : a.transit == "totals" ? KeptTransit::totals
                     : a.transit == "images" ? KeptTransit::images
                                             : KeptTransit::if_small;
  if (a.batch.empty()) return settings;
  settings.batch = static_cast<int>(
      read_argument("--batch", a.batch, {8, Batch::capacity, true, true, "a multiple of 8"}));
  if (settings.batch % 8 != 0)
    throw ArgumentError(fmt::format("--batch must be a multiple of 8 from 8 to {}", Batch::capacity));
  return settings;
}

int run_command(const RunArguments& a, const CLI::App& verb, const std::vector<std::string>& arguments,
                const Snapshot* start) {
  const std::filesystem::path output = a.output.empty()
                                           ? std::filesystem::path(a.experiment.file.stem().string() + ".h5")
                                           : std::filesystem::path(a.output);
  const Setup setup = load(a.experiment.file, a.experiment.changes);
  if (setup.is_model()) refuse_for_a_model(verb);
  RunSettings settings = settings_of(a);
  require_place(output, setup.inputs());
  if (setup.is_model()) {
    run_model(setup, output, arguments);
    return exit_code::done;
  }

  const bool strict = a.experiment.strict;
  std::size_t told = 0;
  const Checkpoints checkpoints(output.string() + ".checkpoint", arguments_to_resume(a, output));
  ProgressLine progress(a.progress);
  settings.planned = [&](const std::vector<Diagnostic>& warnings) {
    tell(warnings, strict, stderr);
    told = warnings.size();
    watch_signals();
  };
  settings.progress = [&](const Progress& p) { progress(p); };
  settings.snapshot = [&](const Snapshot& s) { checkpoints.write_or_warn(s); };
  settings.stop = &stop_requested();
  settings.start = start;
  settings.arguments = arguments;
  const std::optional<Result> result = run(setup, settings);
  progress.clear();
  if (!result) {
    fmt::print(stderr,
               "stopped; what is finished is in {0}.checkpoint\n  help: continue with: rabiline resume {0}\n",
               output.string());
    return exit_code::stopped;
  }
  const std::span ineffective = std::span(result->provenance.warnings).subspan(told);
  for (const std::string& warning : ineffective) fmt::print(stderr, "warning: {}\n", warning);
  write(*result, output);
  checkpoints.remove();
  print_summary(*result, output);
  return strict && !ineffective.empty() ? exit_code::bad_input : exit_code::done;
}

}  // namespace

void add_run(CLI::App& app, const std::vector<std::string>& arguments, const Snapshot* start, int& exit) {
  CLI::App* verb =
      app.add_subcommand("run", "fly the experiment, or solve the model, and write an HDF5 file");
  auto a = std::make_shared<RunArguments>();
  a->experiment.add_to(*verb);
  verb->add_option("-o,--output", a->output,
                   "where the result goes; FILE's name with .h5 where it is missing")
      ->type_name("OUT.h5");
  a->machine.add_to(*verb);
  verb->add_option("--batch", a->batch, "particles per batch; the result is the same for any")
      ->type_name("N");
  verb->add_option("--progress", a->progress, "auto, lines, json or none")
      ->check(CLI::IsMember({"auto", "lines", "json", "none"}));
  verb->add_option("--transit", a->transit,
                   "what is kept for `rabiline rescan`: totals, images too, none, or auto: totals where they "
                   "are a fifth of the file at most")
      ->check(CLI::IsMember({"auto", "none", "totals", "images"}));
  verb->callback([a, verb, &arguments, start, &exit] { exit = run_command(*a, *verb, arguments, start); });
}

void add_resume(CLI::App& app, int& exit) {
  CLI::App* verb = app.add_subcommand("resume", "continue a stopped run, bit-identical");
  auto output = std::make_shared<std::string>();
  verb->add_option("OUT.h5", *output, "the file that the stopped run was to write")->required();
  verb->callback([output, &exit] {
    if (!std::filesystem::exists(*output + ".checkpoint"))
      throw ArgumentError(fmt::format("there is no {}.checkpoint: nothing to resume", *output));
    const Snapshot snapshot = read_snapshot(*output + ".checkpoint");
    exit = run_program(snapshot.arguments, &snapshot);
  });
}

}  // namespace rabiline
