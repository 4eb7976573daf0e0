// rabiline check: every error at once; else the plan and the derived numbers.
#include "commands/common.hpp"

namespace rabiline {

void add_check(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("check", "show every error at once, else the plan and the derived numbers");
  auto options = std::make_shared<ExperimentOptions>();
  options->add_to(*verb);
  verb->callback([options] {
    const Report report = check(load(options->file, options->changes));
    say(stdout, "{}", report.text);
    tell(report.warnings, options->strict, stdout);
  });
}

}  // namespace rabiline
