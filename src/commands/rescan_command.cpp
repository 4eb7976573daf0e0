// rabiline rescan: other scan points of a result, without another flight.
#include "commands/flight.hpp"
#include "commands/stop.hpp"
#include "storage/lock.hpp"
#include "storage/results_file.hpp"

namespace rabiline {
namespace {

struct RescanArguments {
  std::filesystem::path flown;
  Changes changes;
  bool strict = false;
  std::string output;
  MachineOptions machine;
};

int rescan_command(const RescanArguments& a, const std::vector<std::string>& arguments) {
  const std::filesystem::path output = a.output.empty()
                                           ? std::filesystem::path(a.flown.stem().string() + "-rescan.h5")
                                           : std::filesystem::path(a.output);
  end_at_signals();
  require_place(output, {{a.flown.string(), {}}});
  const Lock lock(output);
  require_no_checkpoint(output);
  RunSettings settings = a.machine.settings();
  settings.arguments = arguments;
  settings.planned = [&](const std::vector<Diagnostic>& warnings) { tell(warnings, a.strict, stderr); };
  watch_signals();
  const StoppedAtOnce end("stopped; nothing was written\n");
  ResultsFile file(output);
  settings.points = [&](const Result& points) { file.add(points); };
  const Result result = rescan(a.flown, a.changes, settings);
  file.save(result);
  print_summary(result, output);
  return exit_code::done;
}

}  // namespace

void add_rescan(CLI::App& app, const std::vector<std::string>& arguments, int& exit) {
  CLI::App* verb = app.add_subcommand(
      "rescan",
      "other points of a result's scan, without another flight: of what turns spins and steers "
      "nothing");
  auto a = std::make_shared<RescanArguments>();
  verb->add_option("RESULT.h5", a->flown,
                   "a result that keeps its flight (see `rabiline run --help`, --transit)")
      ->required();
  add_changes_to(*verb, a->changes);
  add_scan_to(*verb, a->changes);
  verb->add_flag("--strict", a->strict, "take warnings for errors: exit code 2");
  verb->add_option("-o,--output", a->output, "where the new result goes; RESULT-rescan.h5 if omitted")
      ->type_name("OUT.h5");
  a->machine.add_isa_to(*verb);
  a->machine.add_memory_to(*verb);
  verb->callback([a, &arguments, &exit] { exit = rescan_command(*a, arguments); });
}

}  // namespace rabiline
