// rabiline trace: the paths of a few particles, by the same kernels as a run.
#include <fmt/format.h>

#include "commands/common.hpp"
#include "simulation/trace.hpp"
#include "storage/safe_file.hpp"
#include "storage/tracks_file.hpp"

namespace rabiline {
namespace {

struct TraceArguments {
  ExperimentOptions experiment;
  std::string output, isa;
  std::string count = "5";
  std::optional<std::string> particle;
};

void trace_command(const TraceArguments& a) {
  const std::uint64_t count = read_argument("-n", a.count, {1, 10000, true, true, "from 1 to 10000"});
  MachineOptions machine;
  machine.isa = a.isa;
  const Isa isa = machine.instruction_set();
  const LoadedExperiment loaded = load_experiment(a.experiment.file, a.experiment.changes);
  require_no_input(a.output, loaded.inputs);
  require_writable(a.output);
  Experiment at_base;
  at_base.points = {loaded.base};
  report_warnings(at_base, make_plan(at_base), loaded.places, a.experiment.strict, stderr);
  std::vector<Track> tracks;
  const std::uint64_t first =
      a.particle ? read_argument("--particle", *a.particle, {0, 1e14, true, true, "zero or greater"}) : 0;
  const std::uint64_t last = a.particle ? first + 1 : std::min(count, loaded.base.particles);
  if (first >= loaded.base.particles)
    throw ArgumentError(fmt::format("--particle: there is no particle {}; the run has {}, counted from 0",
                                    first, loaded.base.particles));
  for (std::uint64_t particle = first; particle < last; ++particle)
    tracks.push_back(trace(loaded.base, particle, isa));
  write_tracks(loaded.base.title, tracks, a.output);
  for (const Track& t : tracks)
    fmt::print("particle {}: {}{}{}, {} places recorded\n", t.particle, t.fate, t.where.empty() ? "" : " at ",
               t.where, t.t.size());
  fmt::print("wrote {}\n", a.output);
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
  verb->add_option("--isa", a->isa, "instruction set: x86-64, avx2 or avx512")->type_name("NAME");
  verb->callback([a] { trace_command(*a); });
}

}  // namespace rabiline
