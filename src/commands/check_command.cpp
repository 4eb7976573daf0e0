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
    const Loaded loaded = load(options->file, options->changes);
    if (const auto* model = std::get_if<LoadedModel>(&loaded)) return fmt::print("{}", check_model(*model));
    const auto& [experiment, inputs, base, places] = std::get<LoadedExperiment>(loaded);
    const Plan plan = make_plan(experiment);
    fmt::print("{}", explain(experiment, plan));
    report_warnings(experiment, plan, places, options->strict, stdout);
  });
}

}  // namespace rabiline
