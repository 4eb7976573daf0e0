// rabiline run: flies the experiment, or solves the model, and writes one HDF5 file.
#include <chrono>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "commands/common.hpp"
#include "simulation/effects.hpp"
#include "simulation/finish.hpp"
#include "simulation/run.hpp"
#include "storage/checkpoint_file.hpp"
#include "storage/results_file.hpp"
#include "storage/safe_file.hpp"
#include "storage/storage_error.hpp"

namespace rabiline {
namespace {

struct RunArguments {
  ExperimentOptions experiment;
  MachineOptions machine;
  std::string output;
  std::string progress = "auto";
  std::string batch;  // empty: the largest
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
      fmt::print(stderr, "\r{:5.1f} %  {} left      ", 100 * p.done, duration(p.seconds_left));
      shown_ = true;
      return;
    }
    if (p.seconds < next_) return;
    next_ = p.seconds + 10;
    if (json_)
      fmt::print(stderr, "{{\"done\": {:.4f}, \"seconds\": {:.1f}, \"seconds_left\": {:.1f}}}\n", p.done,
                 p.seconds, p.seconds_left);
    else
      fmt::print(stderr, "{:5.1f} %  {} left\n", 100 * p.done, duration(p.seconds_left));
  }
  void clear() const {
    if (shown_) fmt::print(stderr, "\r{:40}\r", "");
  }

 private:
  bool terminal_, json_, quiet_, shown_ = false;
  double next_ = 0;
};

void print_summary(const Result& result, const std::filesystem::path& output, double seconds) {
  const std::size_t points = result.emitted.size();
  fmt::print("{}: {} scan point{}, {} particles each, {:.2f} s\n", result.title, points,
             points == 1 ? "" : "s", result.particles, seconds);
  for (const DetectorResult& d : result.detectors) {
    const auto [least, most] = std::minmax_element(d.detected.begin(), d.detected.end());
    if (points == 1)
      fmt::print("  {}: {:.4g} +- {:.2g} of the emitted particles\n", d.name, d.detected[0],
                 d.detected_errors[0]);
    else
      fmt::print("  {}: from {:.4g} to {:.4g} of the emitted particles\n", d.name, *least, *most);
  }
  fmt::print("wrote {}\n", output.string());
}

/// The command that goes on with this run from any folder.
std::vector<std::string> arguments_to_resume(const RunArguments& a, const std::filesystem::path& output) {
  const CommandLine& changes = a.experiment.changes;
  std::vector<std::string> arguments{"run", std::filesystem::absolute(a.experiment.file).string(), "-o",
                                     std::filesystem::absolute(output).string()};
  const auto add = [&](const char* option, const std::string& value) {
    arguments.insert(arguments.end(), {option, value});
  };
  if (a.experiment.strict) arguments.push_back("--strict");
  for (const std::string& change : changes.set) add("--set", change);
  for (const std::string& scan : changes.scan) add("--scan", scan);
  if (changes.without_scan) arguments.emplace_back("--no-scan");
  if (changes.particles) add("--particles", *changes.particles);
  if (changes.seed) add("--seed", *changes.seed);
  if (!a.machine.threads.empty()) add("--threads", a.machine.threads);
  if (!a.machine.isa.empty()) add("--isa", a.machine.isa);
  if (!a.batch.empty()) add("--batch", a.batch);
  add("--progress", a.progress);
  return arguments;
}

/// Writes checkpoints; one that cannot be written is worth a warning, not the run.
class Checkpoints {
 public:
  Checkpoints(std::filesystem::path path, std::string fingerprint, const LoadedExperiment& loaded,
              const std::vector<std::string>& arguments)
      : path_(std::move(path)),
        fingerprint_(std::move(fingerprint)),
        loaded_(loaded),
        arguments_(arguments) {}

  void write(Snapshot snapshot) const {
    snapshot.fingerprint = fingerprint_;
    snapshot.arguments = arguments_;
    snapshot.inputs = loaded_.inputs;
    write_checkpoint(snapshot, path_);
  }
  void write_or_warn(const Snapshot& snapshot) const {
    try {
      write(snapshot);
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
  std::string fingerprint_;
  const LoadedExperiment& loaded_;
  std::vector<std::string> arguments_;
};

/// Sums of every thread and of the whole, and what threads keep at planes, must fit into the machine.
void require_memory(const Plan& plan, int threads) {
  const double needed = static_cast<double>(plan.sums) * sizeof(Sum) * (threads + 2) +
                        static_cast<double>(bytes_of_stages(plan)) * threads;
  const double there =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  if (needed > 0.7 * there)
    throw ArgumentError(fmt::format(
        "the histograms of {} scan points need {:.1f} GiB on {} threads, and this machine has {:.1f} GiB\n"
        "  help: use fewer bins, fewer scan points or fewer threads",
        plan.points, needed / 1073741824, threads, there / 1073741824));
}

/// What has a meaning for particles alone.
void refuse_for_a_model(const CLI::App& verb) {
  for (const char* option : {"--threads", "--isa", "--batch", "--progress"})
    if (verb.count(option) > 0)
      throw ArgumentError(
          fmt::format("{} has no meaning for a model: it is solved, not flown\n  help: omit it", option));
}

int run_command(const RunArguments& a, const CLI::App& verb, const std::vector<std::string>& arguments,
                const Snapshot* start) {
  const std::filesystem::path output = a.output.empty()
                                           ? std::filesystem::path(a.experiment.file.stem().string() + ".h5")
                                           : std::filesystem::path(a.output);
  const int batch = a.batch.empty()
                        ? Batch::capacity
                        : static_cast<int>(read_argument(
                              "--batch", a.batch, {8, Batch::capacity, true, true, "a multiple of 8"}));
  if (batch % 8 != 0)
    throw ArgumentError(fmt::format("--batch must be a multiple of 8 from 8 to {}", Batch::capacity));
  const Loaded file = load(a.experiment.file, a.experiment.changes);
  if (std::holds_alternative<LoadedModel>(file)) refuse_for_a_model(verb);
  require_no_input(output, std::visit([](const auto& any) { return any.inputs; }, file));
  require_writable(output);
  if (const auto* model = std::get_if<LoadedModel>(&file)) {
    run_model(*model, output, arguments);
    return exit_code::done;
  }
  const auto& loaded = std::get<LoadedExperiment>(file);
  const std::string identity = fingerprint(loaded, a.experiment.changes);
  if (start != nullptr && start->fingerprint != identity)
    throw ArgumentError("the checkpoint does not match: " + a.experiment.file.string() +
                        " or the program has changed since it was written");

  Provenance provenance = provenance_of(arguments, loaded.inputs);
  provenance.instruction_set = name_of(a.machine.instruction_set());
  provenance.threads = a.machine.thread_count();
  const auto begin = std::chrono::steady_clock::now();
  const Plan plan = make_plan(loaded.experiment, a.machine.thread_count());
  require_memory(plan, a.machine.thread_count());
  provenance.warnings = report_warnings(loaded.experiment, plan, loaded.places, a.experiment.strict, stderr);
  if (start != nullptr && !fits(*start, plan)) throw ArgumentError("the checkpoint does not fit the plan");
  const Checkpoints checkpoints(output.string() + ".checkpoint", identity, loaded,
                                arguments_to_resume(a, output));
  ProgressLine progress(a.progress);
  RunOptions options;
  options.threads = a.machine.thread_count();
  options.isa = a.machine.instruction_set();
  options.batch = batch;
  options.stop = &stop_requested();
  options.progress = [&](const Progress& p) { progress(p); };
  options.snapshot = [&](const Snapshot& s) { checkpoints.write_or_warn(s); };
  options.start = start;

  watch_signals();
  const RunOutcome outcome = run(plan, options);
  provenance.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  provenance.end_time = now();
  progress.clear();
  if (!outcome.finished) {
    fmt::print(stderr,
               "stopped; what is finished is in {0}.checkpoint\n  help: continue with: rabiline resume {0}\n",
               output.string());
    return exit_code::stopped;
  }
  Result result = finish(loaded.experiment, plan, outcome.sums);
  result.provenance = std::move(provenance);
  const std::vector<std::string> ineffective = warnings_of(result);
  for (const std::string& warning : ineffective) fmt::print(stderr, "warning: {}\n", warning);
  result.provenance.warnings.insert(result.provenance.warnings.end(), ineffective.begin(), ineffective.end());
  write_results(result, output);
  checkpoints.remove();
  print_summary(result, output, result.provenance.seconds);
  return a.experiment.strict && !ineffective.empty() ? exit_code::bad_input : exit_code::done;
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
  verb->callback([a, verb, &arguments, start, &exit] { exit = run_command(*a, *verb, arguments, start); });
}

void add_resume(CLI::App& app, int& exit) {
  CLI::App* verb = app.add_subcommand("resume", "continue a stopped run, bit-identical");
  auto output = std::make_shared<std::string>();
  verb->add_option("OUT.h5", *output, "the file that the stopped run was to write")->required();
  verb->callback([output, &exit] {
    if (!std::filesystem::exists(*output + ".checkpoint"))
      throw ArgumentError(fmt::format("there is no {}.checkpoint: nothing to resume", *output));
    const Snapshot snapshot = read_checkpoint(*output + ".checkpoint");
    exit = run_program(snapshot.arguments, &snapshot);
  });
}

}  // namespace rabiline
