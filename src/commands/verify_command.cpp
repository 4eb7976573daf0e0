// rabiline verify and reproduce: whether a file is what was written, and whether what was written comes
// again.
#include <fmt/format.h>

#include <algorithm>

#include "commands/common.hpp"
#include "commands/stop.hpp"
#include "storage/safe_file.hpp"

namespace rabiline {
namespace {

struct ReproduceArguments {
  std::filesystem::path file;
  MachineOptions machine;
};

/// One for each of the first paths.
std::string lines_of(const std::vector<std::string>& differing) {
  constexpr std::size_t most = 12;
  std::string out;
  for (std::size_t i = 0; i < std::min(most, differing.size()); ++i)
    out += fmt::format("  differing: {}\n", differing[i]);
  if (differing.size() > most) out += fmt::format("  and {} more\n", differing.size() - most);
  return out;
}

int reproduce_command(const ReproduceArguments& a, Ranks* ranks) {
  RunSettings settings = a.machine.settings();
  settings.ranks = ranks;
  settings.stop = &stop_requested();
  watch_signals();
  const Reproduced again = reproduce(a.file, settings);
  return std::visit(
      [&](const auto& result) {
        if (again.differing.empty()) {
          say(stdout, "{}: comes out again with the same bits, {:.2f} s\n", a.file.string(),
              result.provenance.seconds);
          return exit_code::done;
        }
        const std::filesystem::path other = a.file.stem().string() + "-again.h5";
        require_place(other, {{a.file.string(), {}}});
        back_up(other);
        write(result, other);
        say(stderr,
            "error: {} comes out otherwise here\n{}  help: compare it with {}: another version of the "
            "program wrote it (see /entry/simulation/commit), it was changed since, or one of the machines "
            "computes wrongly\n",
            a.file.string(), lines_of(again.differing), other.string());
        return exit_code::not_written;
      },
      again.result);
}

}  // namespace

void add_verify(CLI::App& app, int& exit) {
  CLI::App* verb =
      app.add_subcommand("verify", "tell whether files are, to the bit, what this program wrote");
  auto files = std::make_shared<std::vector<std::string>>();
  verb->add_option("FILE.h5", *files, "results, tracks, shards or checkpoints")->required();
  verb->callback([files, &exit] {
    for (const std::string& file : *files) {
      const int of_this = explained([&] {
        say(stdout, "{}: whole, SHA-256 {}\n", file, verify(file));
        return exit_code::done;
      });
      if (exit == exit_code::done) exit = of_this;
    }
  });
}

void add_reproduce(CLI::App& app, Ranks* ranks, int& exit) {
  CLI::App* verb =
      app.add_subcommand("reproduce", "fly or solve again what a file was made from, and compare bit by bit");
  auto a = std::make_shared<ReproduceArguments>();
  verb->add_option("OUT.h5", a->file, "what `rabiline run` wrote")->required();
  a->machine.add_to(*verb);
  verb->callback([a, ranks, &exit] { exit = reproduce_command(*a, ranks); });
}

}  // namespace rabiline
