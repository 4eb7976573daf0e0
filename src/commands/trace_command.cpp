// rabiline trace: the paths of a few particles, by the same kernels as a run.
#include <map>

#include "commands/flight.hpp"
#include "commands/stop.hpp"
#include "scan/settings.hpp"
#include "storage/lock.hpp"

namespace rabiline {
namespace {

struct TraceArguments {
  ExperimentOptions experiment;
  MachineOptions machine;
  std::string output;
  std::string count = "5";
  std::optional<std::string> particle;
};

/// A line for each particle; of many, for each fate.
void tell(const std::vector<Track>& tracks) {
  constexpr std::size_t few = 20;
  std::map<std::string, std::size_t> fates;
  for (const Track& t : tracks) {
    const std::string fate = fmt::format("{}{}{}", t.fate, t.where.empty() ? "" : " at ", t.where);
    const std::string left =
        t.weight.back() < 1 && t.weight.back() > 0 ? fmt::format(", {:.3g} of it", t.weight.back()) : "";
    if (tracks.size() <= few)
      say(stdout, "particle {}: {}{}, {} places recorded\n", t.particle, fate, left, t.t.size());
    ++fates[fate];
  }
  if (tracks.size() <= few) return;
  for (const auto& [fate, count] : fates) say(stdout, "{} particles: {}\n", count, fate);
}

void trace_command(const TraceArguments& a) {
  const std::uint64_t count = read_argument("-n", a.count, {1, 10000, true, true, "from 1 to 10000"});
  const std::uint64_t first =
      a.particle ? read_argument("--particle", *a.particle, {0, 1e14, true, true, "from 0 to 1e14"}) : 0;
  RunSettings settings = a.machine.settings();
  settings.planned = [&](const std::vector<Diagnostic>& warnings) {
    tell(warnings, a.experiment.strict, stderr);
    watch_signals();
  };
  settings.stop = &stop_requested();
  end_at_signals();
  const Setup setup = load_beamline(a.experiment.file, a.experiment.changes);
  require_place(a.output, with_file(setup.inputs(), a.experiment.file));
  const Lock lock(a.output);
  require_no_checkpoint(a.output);
  const std::vector<Track> tracks =
      blaming("--particle", [&] { return trace(setup, first, a.particle ? 1 : count, settings); });
  write(tracks, setup, a.output);
  tell(tracks);
  if (!a.particle && tracks.size() < count)
    say(stdout, "the run has no more particles than these {}\n", tracks.size());
  say(stdout, "wrote {}\n", a.output);
}

}  // namespace

void add_trace(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("trace", "write the paths of a few particles, without the file's scan");
  auto a = std::make_shared<TraceArguments>();
  a->experiment.add_without_scan_to(*verb);
  CLI::Option* count = verb->add_option("-n", a->count, "how many particles, from number 0")->type_name("N");
  verb->add_option("--particle", a->particle, "only the particle of this number")
      ->type_name("N")
      ->excludes(count);
  verb->add_option("-o,--output", a->output, "where the paths go")->type_name("TRACKS.h5")->required();
  a->machine.add_isa_to(*verb);
  verb->callback([a] { trace_command(*a); });
}

}  // namespace rabiline
