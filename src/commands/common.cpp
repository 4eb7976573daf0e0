#include "commands/common.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <sstream>

#include <fmt/ranges.h>

#include "commands/arguments.hpp"
#include "commands/mpi_ranks.hpp"
#include "commands/stop.hpp"
#include "core/isa.hpp"
#include "core/version.hpp"
#include "scan/settings.hpp"
#include "storage/safe_file.hpp"

namespace rabiline {

int explained(const std::function<int()>& call) {
  try {
    return call();
  } catch (const InputError& error) {
    say(stderr, "{}", render(error.diagnostics()));
    return exit_code::bad_input;
  } catch (const ArgumentError& error) {
    say(stderr, "error: {}\n", error.what());
    return exit_code::bad_input;
  } catch (const std::invalid_argument& error) {
    say(stderr, "error: {}\n", error.what());
    return exit_code::bad_input;
  } catch (const StorageError& error) {
    say(stderr, "error: {}\n", error.what());
    return exit_code::not_written;
  } catch (const std::filesystem::filesystem_error& error) {
    say(stderr, "error: {}: {}\n", error.path1().string(), error.code().message());
    return exit_code::not_written;
  } catch (const RankFailure& error) {
    say(stderr, "error: {}\n  help: mend that, and start again: `rabiline run` goes on from its checkpoint\n",
        error.what());
    return exit_code::bad_input;
  } catch (const Stopped&) {
    say(stderr, "stopped; nothing was written\n");
    return exit_code::stopped;
  } catch (const std::bad_alloc&) {
    say(stderr, "error: not enough memory\n  help: use fewer bins or fewer scan points\n");
    return exit_code::bad_input;
  } catch (const std::exception& error) {
    say(stderr, "error: {}\n  help: this is a mistake of the program: please report it with the input file\n",
        error.what());
    return exit_code::mistake;
  }
}

namespace {

/// What CLI11 found wrong, in our form.
std::string told(const CLI::ParseError& error, const std::vector<std::string>& arguments) {
  const bool has_verb = !arguments.empty() && !arguments.front().starts_with('-');
  return fmt::format("{}\n  help: `rabiline {}--help` tells what there is", error.what(),
                     has_verb ? arguments.front() + " " : "");
}

/// HDF5 goes under no name that promises a table or a picture, and results not where checkpoints go.
void require_name_of_hdf5(const std::filesystem::path& output) {
  if (output.extension() == ".checkpoint")
    throw ArgumentError(
        fmt::format("{} is named like the checkpoint of a run, which would be lost\n  help: write results to "
                    "another file, such as {}",
                    output.string(), std::filesystem::path(output).replace_filename("results.h5").string()));
  static constexpr std::array<std::string_view, 5> endings{".csv", ".txt", ".png", ".pdf", ".svg"};
  const auto found = std::ranges::find(endings, output.extension().string());
  if (found == endings.end()) return;
  const bool is_table = found - endings.begin() < 2;
  std::filesystem::path named = output;
  named.replace_extension(".h5");
  throw ArgumentError(
      fmt::format("-o {0} is named like a {1}, but HDF5 is written\n  help: write `-o {2}`, then `rabiline "
                  "{3} {2} {4} {0}`",
                  output.string(), is_table ? "table" : "picture", named.string(),
                  is_table ? "export" : "plot", is_table ? ">" : "-o"));
}

}  // namespace

void ExperimentOptions::add_to(CLI::App& app) {
  add_without_scan_to(app);
  app.get_option("FILE")->description("an experiment or a model, a YAML file");
  changes.without_scan = false;
  add_scan_to(app, changes);
}

void add_scan_to(CLI::App& app, Changes& changes) {
  app.add_option(
         "--scan", changes.scan,
         "scan a parameter, e.g. --scan 'H0.frequency=290 kHz:293 kHz:61'; `:log` behind it spreads the "
         "points in equal ratios; several names with commas between take each value together")
      ->type_name("NAME[,NAME]=FROM:TO:POINTS[:log]|NAME[,NAME]=A,B,C")
      ->allow_extra_args(false);
  app.add_flag("--no-scan", changes.without_scan, "omit the file's scan");
}

void add_changes_to(CLI::App& app, Changes& changes) {
  app.add_option("--set", changes.set, "change a parameter for this time, e.g. --set 'B.field=9 mT'")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
}

void ExperimentOptions::add_without_scan_to(CLI::App& app) {
  changes.without_scan = true;
  app.add_option("FILE", file, "the experiment, a YAML file")->required();
  add_changes_to(app, changes);
  app.add_option("--particles", changes.particles, "particles per scan point, such as 1e6")->type_name("N");
  app.add_option("--seed", changes.seed, "seed of all random numbers")->type_name("S");
  app.add_flag("--strict", strict, "take warnings for errors: exit code 2");
}

void MachineOptions::add_to(CLI::App& app) {
  app.add_option("--threads", threads, "threads; the result is the same for any number")->type_name("T");
  add_isa_to(app);
}

void MachineOptions::add_memory_to(CLI::App& app) {
  app.add_option(
         "--max-memory", max_memory,
         "memory that may be used, such as 2GiB: a longer scan is worked out in slabs of its points, and "
         "what needs more is refused; 2GiB for slabs, and else what the machine has, if omitted")
      ->type_name("SIZE");
}

void MachineOptions::add_isa_to(CLI::App& app) {
  app.add_option("--isa", isa, "instruction set: x86-64, avx2 or avx512; the result is the same for any")
      ->type_name("NAME");
}

RunSettings MachineOptions::settings() const {
  RunSettings out;
  blaming("--isa", [&] { return isa_called(isa); });
  out.isa = isa;
  if (!max_memory.empty()) out.max_memory = read_memory_argument("--max-memory", max_memory);
  if (!threads.empty())
    out.threads =
        static_cast<int>(read_argument("--threads", threads, {1, 1024, true, true, "from 1 to 1024"}));
  return out;
}

void tell(std::vector<Diagnostic> warnings, bool strict, FILE* to) {
  if (strict && !warnings.empty()) {
    for (Diagnostic& warning : warnings) warning.severity = Severity::error;
    throw InputError(std::move(warnings));
  }
  say(to, "{}", render(warnings));
}

std::string headed(const std::string& title) { return title.empty() ? "" : title + ": "; }

void print_summary(const Result& result, const std::filesystem::path& output, std::string_view note) {
  const std::size_t points = result.emitted.size();
  std::string particles = fmt::format("{} particle{}", result.particles, result.particles == 1 ? "" : "s");
  for (const ScanAxis& axis : result.axes)
    if (axis.parameter == "particles" && !axis.values.empty()) {
      const auto [fewest, most] = std::minmax_element(axis.values.begin(), axis.values.end());
      particles = fmt::format("{:.0f} to {:.0f} particles", *fewest, *most);
    }
  say(stdout, "{}{}{}{}, {:.2f} s\n", headed(result.title),
      points == 1 ? "" : fmt::format("{} scan points, ", points), particles, points == 1 ? "" : " each",
      result.provenance.seconds);
  for (const DetectorResult& d : result.detectors) {
    const auto [least, most] = std::minmax_element(d.detected.begin(), d.detected.end());
    if (points == 1)
      say(stdout, "  {}: {:.4g} +- {:.2g} of the emitted particles\n", d.name, d.detected[0],
          d.detected_errors[0]);
    else
      say(stdout, "  {}: from {:.4g} to {:.4g} of the emitted particles\n", d.name, *least, *most);
  }
  if (result.field_check && result.field_check->particles == 0)
    say(stdout, "  steps not checked: {}\n",
        result.field_check->approximated
            ? "where levels are driven in the rotating-wave approximation, there is no whole field to "
              "integrate"
            : "an independent integration takes longer than a second for one particle, or none gets through");
  say(stdout, "{}wrote {}\n", note, output.string());
}

void require_place(const std::filesystem::path& output, const std::vector<InputText>& inputs) {
  require_name_of_hdf5(output);
  for (const InputText& input : inputs) {
    std::error_code none;  // of a file that is not there yet
    if (std::filesystem::equivalent(output.string() + ".checkpoint", input.path, none))
      throw ArgumentError(
          fmt::format("{} is where checkpoints of -o {} go\n  help: write results to another file",
                      input.path, output.string()));
    if (std::filesystem::equivalent(output, input.path, none))
      throw ArgumentError(
          fmt::format("-o {} is what the experiment is read from\n  help: write results to another file",
                      output.string()));
  }
  require_writable(output);
}

std::vector<InputText> with_file(std::vector<InputText> inputs, const std::filesystem::path& file) {
  inputs.push_back({file.string(), {}});
  return inputs;
}

namespace {

int parse_and_run(const std::vector<std::string>& arguments, Ranks* ranks) {
  CLI::App app{"rabiline: particle beams with spin through magnetic fields, by Monte Carlo", "rabiline"};
  app.set_version_flag("--version", std::string("rabiline ") + version);
  app.require_subcommand(1);
  app.footer(
      "A starter file: rabiline new ramsey\n"
      "What is in it:  rabiline check ramsey.yaml\n"
      "A first run:    rabiline run ramsey.yaml -o results.h5\n"
      "All keys:       rabiline describe\n"
      "Exit codes: 0 done, 2 bad input or arguments, 3 a file could not be written or read, 4 stopped with a "
      "checkpoint, 1 a mistake of the program.");
  int exit = exit_code::done;
  add_run(app, arguments, ranks, exit);
  add_check(app, exit);
  add_describe(app);
  add_trace(app);
  add_probe(app);
  add_resume(app, ranks, exit);
  add_merge(app, ranks, exit);
  add_verify(app, exit);
  add_reproduce(app, ranks, exit);
  add_rescan(app, arguments, exit);
  add_package_verbs(app);
  require_known_verb(app, arguments);
  if (!arguments.empty() && is_of_the_package(arguments.front())) start_package(arguments);
  require_known_arguments(app, arguments);
  try {
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());  // as CLI11 wants them
    app.parse(reversed);
    return exit;
  } catch (const CLI::ParseError& error) {
    std::ostringstream out, err;
    if (app.exit(error, out, err) != 0) throw ArgumentError(told(error, arguments));
    put(stdout, out.str());
    return exit_code::done;
  }
}

/// One that does not lead is stopped by signals as the leader is.
int fly_along(Ranks& ranks) {
  watch_signals();
  return assist(ranks, &stop_requested());
}

/// Whether text is all that was asked for.
bool prints(const std::vector<std::string>& arguments) {
  static constexpr std::array<std::string_view, 6> writers{"run",   "resume", "merge",
                                                           "trace", "rescan", "reproduce"};
  return arguments.empty() || std::ranges::find(writers, arguments.front()) == writers.end() ||
         std::ranges::any_of(arguments, [](const std::string& a) { return a == "--help" || a == "-h"; });
}

}  // namespace

int run_program(const std::vector<std::string>& arguments) {
  ignore_failed_writes();
  if (is_left_to_the_first(arguments)) return exit_code::done;
  std::unique_ptr<Ranks> ranks;
  const int code = explained([&] {
    ranks = launched_ranks(arguments);
    return ranks && !ranks->leads() ? fly_along(*ranks) : parse_and_run(arguments, ranks.get());
  });
  if (ranks && ranks->leads()) dismiss(*ranks, code);
  const bool is_asked_for = prints(arguments);
  const std::string lost = lost_text(is_asked_for);
  if (lost.empty() || code != exit_code::done) return code;
  say(stderr, "{}: what was to be printed could not be written to the standard output ({})\n",
      is_asked_for ? "error" : "warning", lost);
  return is_asked_for ? exit_code::not_written : code;
}

}  // namespace rabiline
