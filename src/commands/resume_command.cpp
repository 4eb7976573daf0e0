// rabiline resume and merge: a result from sums that have been flown before.
#include "commands/flight.hpp"
#include "commands/stop.hpp"

namespace rabiline {
namespace {

/// The arguments are those that the run began with. Sums that no flight can have are those of a damaged file.
int finish(Snapshot flown, const std::string& files, const std::filesystem::path& output,
           const FlightOptions& options, Ranks* ranks) try {
  const Setup setup = load(flown);
  RunSettings settings = options.settings();
  settings.transit = flown.transit;
  settings.max_memory = flown.max_memory;
  settings.shard = flown.shard;
  settings.arguments = flown.arguments;
  settings.ranks = ranks;
  require_place(output, {});
  return fly(setup, output, options, settings, std::move(flown));
} catch (const std::logic_error& contradiction) {
  throw StorageError(fmt::format("{} cannot be used: {}", files, contradiction.what()));
}

/// Of a checkpoint, its result is named.
[[noreturn]] void refuse_to_resume(const std::filesystem::path& output,
                                   const std::filesystem::path& checkpoint) {
  const std::filesystem::path result = std::filesystem::path(output).replace_extension();
  const bool is_checkpoint = checkpoint_of(result) == output && std::filesystem::exists(output);
  throw StorageError(
      is_checkpoint ? fmt::format("{} is a checkpoint, and `resume` takes the name of its result\n  help: "
                                  "rabiline resume {}",
                                  output.string(), quoted(result))
                    : fmt::format("there is no {}: nothing to resume", checkpoint.string()));
}

}  // namespace

void add_resume(CLI::App& app, Ranks* ranks, int& exit) {
  CLI::App* verb = app.add_subcommand("resume", "continue a stopped run, bit-identical");
  auto output = std::make_shared<std::string>();
  auto options = std::make_shared<FlightOptions>();
  verb->add_option("OUT.h5", *output, "what the run was to write; it continues from OUT.h5.checkpoint")
      ->required();
  options->add_to(*verb);
  verb->add_flag("--strict", options->strict, "take warnings for errors: exit code 2");
  verb->callback([output, options, ranks, &exit] {
    const std::filesystem::path checkpoint = checkpoint_of(*output);
    if (!std::filesystem::exists(checkpoint)) refuse_to_resume(*output, checkpoint);
    end_at_signals();
    exit = finish(read_snapshot(checkpoint), checkpoint.string(), *output, *options, ranks);
  });
}

void add_merge(CLI::App& app, Ranks* ranks, int& exit) {
  CLI::App* verb =
      app.add_subcommand("merge", "join the shards of a run, bit-identical to the run in one piece");
  auto output = std::make_shared<std::string>();
  auto parts = std::make_shared<std::vector<std::string>>();
  auto options = std::make_shared<FlightOptions>();
  verb->add_option("OUT.h5", *output, "where the result goes")->required();
  verb->add_option("PARTS.h5", *parts, "what `rabiline run --shard` wrote, in any order")->required();
  options->add_to(*verb);
  verb->callback([output, parts, options, ranks, &exit] {
    end_at_signals();
    Merger merger;
    for (const std::string& part : *parts) {
      std::error_code none;  // of an output that is not there yet
      if (std::filesystem::path(part) == std::filesystem::path(*output) ||
          std::filesystem::equivalent(part, *output, none))
        throw ArgumentError(fmt::format("{} is what is merged\n  help: name the new file first", part));
      merger.add(part, read_snapshot(part));
    }
    require_no_checkpoint(*output);
    exit = finish(merger.finish(), "what is merged", *output, *options, ranks);
  });
}

}  // namespace rabiline
