// rabiline verify and reproduce: whether a file is what was written, and whether what was written comes
// again.
#include "commands/common.hpp"
#include "commands/stop.hpp"

namespace rabiline {
namespace {

struct ReproduceArguments {
  std::filesystem::path file;
  MachineOptions machine;
};

int reproduce_command(const ReproduceArguments& a) {
  RunSettings settings = a.machine.settings();
  settings.stop = &stop_requested();
  settings.planned = [](const std::vector<Diagnostic>&) { watch_signals(); };
  const std::optional<Reproduced> again = reproduce(a.file, settings);
  if (!again) {
    say(stderr, "stopped; nothing was written\n");
    return exit_code::stopped;
  }
  if (again->same) {
    say(stdout, "{}: flown again with the same bits, {:.2f} s\n", a.file.string(),
        again->result.provenance.seconds);
    return exit_code::done;
  }
  const std::filesystem::path other = a.file.stem().string() + "-again.h5";
  require_place(other, {{a.file.string(), {}}});
  write(again->result, other);
  say(stderr,
      "error: {} comes out otherwise here: see `h5diff {} {}`\n  help: another version of the program wrote "
      "it, or one "
      "of the machines computes wrongly\n",
      a.file.string(), a.file.string(), other.string());
  return exit_code::not_written;
}

}  // namespace

void add_verify(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("verify", "tell whether files are, to the bit, what this program wrote");
  auto files = std::make_shared<std::vector<std::string>>();
  verb->add_option("FILE.h5", *files, "results, tracks, shards or checkpoints")->required();
  verb->callback([files] {
    for (const std::string& file : *files) say(stdout, "{}: whole, SHA-256 {}\n", file, verify(file));
  });
}

void add_reproduce(CLI::App& app, int& exit) {
  CLI::App* verb =
      app.add_subcommand("reproduce", "fly again what a result was made from, and compare bit by bit");
  auto a = std::make_shared<ReproduceArguments>();
  verb->add_option("OUT.h5", a->file, "the result of a flight")->required();
  a->machine.add_to(*verb);
  verb->callback([a, &exit] { exit = reproduce_command(*a); });
}

}  // namespace rabiline
