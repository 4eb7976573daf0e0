// rabiline check: every error at once; else the plan and the derived numbers.
#include <fmt/format.h>

#include "commands/common.hpp"
#include "plan/explain.hpp"

namespace rabiline {

void add_check(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("check", "show every error at once, else the plan and the derived numbers");
  auto options = std::make_shared<ExperimentOptions>();
  options->add_to(*verb);
  verb->callback([options] {
    const LoadedExperiment loaded = load_experiment(options->file, options->changes);
    fmt::print("{}", explain(loaded.experiment, make_plan(loaded.experiment)));
  });
}

}  // namespace rabiline
