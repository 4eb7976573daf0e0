// rabiline run: flies the experiment, or solves the model, and writes one HDF5 file.
#include "commands/flight.hpp"
#include "commands/stop.hpp"
#include "scan/settings.hpp"

namespace rabiline {
namespace {

struct RunArguments {
  ExperimentOptions experiment;
  FlightOptions flight;
  std::string output;
  std::string transit = "auto";
  std::string shard;  // "2/8"
};

/// What has a meaning for particles alone.
void refuse_for_a_model(const CLI::App& verb) {
  for (const char* option : {"--threads", "--isa", "--batch", "--progress", "--transit", "--checkpoint-every",
                             "--shard", "--max-memory"})
    if (verb.count(option) > 0)
      throw ArgumentError(
          fmt::format("{} has no meaning for a model: it is solved, not flown\n  help: omit it", option));
}

Shard shard_of(const std::string& text) {
  const std::size_t slash = text.find('/');
  constexpr std::string_view digits = "0123456789";
  const bool has_two_numbers = slash != std::string::npos && slash > 0 && slash + 1 < text.size() &&
                               text.find_first_not_of(digits) == slash &&
                               text.find_first_not_of(digits, slash + 1) == std::string::npos;
  if (!has_two_numbers)
    throw ArgumentError(fmt::format("--shard is NUMBER/OF, such as 2/8, but `{}` stands here", text));
  const Range positive{1, 1 << 20, true, true, "from 1 to 1048576"};
  const Shard shard{read_argument("--shard", text.substr(0, slash), positive),
                    read_argument("--shard", text.substr(slash + 1), positive)};
  if (shard.number > shard.of)
    throw ArgumentError(
        fmt::format("there is no shard {} of {}\n  help: they are counted from 1", shard.number, shard.of));
  return shard;
}

RunSettings settings_of(const RunArguments& a) {
  RunSettings settings = a.flight.settings();
  settings.transit = a.transit == "none"     ? KeptTransit::none
                     : a.transit == "totals" ? KeptTransit::totals
                     : a.transit == "images" ? KeptTransit::images
                                             : KeptTransit::if_small;
  if (!a.shard.empty()) settings.shard = shard_of(a.shard);
  return settings;
}

int run_command(RunArguments& a, const CLI::App& verb, const std::vector<std::string>& arguments,
                Ranks* ranks) {
  end_at_signals();
  a.flight.strict = a.experiment.strict;
  const bool again = a.experiment.file.extension() == ".h5";  // the experiment of a result
  const std::filesystem::path output =
      verb.count("-o") == 0
          ? std::filesystem::path(a.experiment.file.stem().string() + (again ? "-run.h5" : ".h5"))
          : std::filesystem::path(a.output);
  const Setup setup = load(a.experiment.file, a.experiment.changes);
  if (setup.is_model()) refuse_for_a_model(verb);
  RunSettings settings = settings_of(a);
  require_place(output, with_file(setup.inputs(), a.experiment.file));
  if (setup.is_model()) {
    run_model(setup, output, a.flight, arguments);
    return exit_code::done;
  }
  settings.arguments = arguments;
  settings.ranks = ranks;
  return fly(setup, output, a.flight, settings, {});
}

}  // namespace

void add_run(CLI::App& app, const std::vector<std::string>& arguments, Ranks* ranks, int& exit) {
  CLI::App* verb =
      app.add_subcommand("run", "fly the experiment, or solve the model, and write an HDF5 file");
  auto a = std::make_shared<RunArguments>();
  a->experiment.add_to(*verb);
  verb->add_option("-o,--output", a->output,
                   "where the result goes; FILE's name with .h5 if omitted, or -run.h5 where FILE "
                   "is a result")
      ->type_name("OUT.h5");
  a->flight.add_to(*verb);
  a->flight.machine.add_memory_to(*verb);
  verb->add_option("--transit", a->transit,
                   "what is kept for `rabiline rescan`: totals, images and tallies too, none, or auto: "
                   "totals where they are a fifth of the file at most")
      ->check(CLI::IsMember({"auto", "none", "totals", "images"}));
  verb->add_option(
          "--shard", a->shard,
          "fly one share of the work, such as 2/8, and write its sums; `rabiline merge` joins all of them")
      ->type_name("NUMBER/OF");
  verb->callback([a, verb, &arguments, ranks, &exit] { exit = run_command(*a, *verb, arguments, ranks); });
}

}  // namespace rabiline
