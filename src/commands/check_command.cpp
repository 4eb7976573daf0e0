// rabiline check: every error at once; else the plan and the derived numbers.
#include <fmt/ranges.h>

#include "commands/common.hpp"
#include "commands/progress_line.hpp"

namespace rabiline {
namespace {

std::string in_json(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += fmt::format("\\{}", c);
    else if (static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      out += c;
  }
  return printable(out) + '"';
}

std::string in_json(const std::vector<Diagnostic>& diagnostics) {
  std::vector<std::string> out;
  out.reserve(diagnostics.size());
  for (const Diagnostic& d : diagnostics)
    out.push_back(fmt::format(R"({{"file": {}, "line": {}, "column": {}, "message": {}, "help": {}}})",
                              in_json(d.place.text ? d.place.text->name : ""), d.place.line, d.place.column,
                              in_json(d.message), in_json(d.suggestion)));
  return fmt::format("[{}]", fmt::join(out, ", "));
}

void print_json(const std::vector<Diagnostic>& errors, const Report& report, std::size_t points) {
  const std::string cost = report.cost ? fmt::format(R"({{"seconds": {:.3g}, "bytes": {:.0f}}})",
                                                     report.cost->seconds, report.cost->memory)
                                       : "null";
  fmt::print(R"({{"errors": {}, "warnings": {}, "points": {}, "cost": {}, "plan": {}}})"
             "\n",
             in_json(errors), in_json(report.warnings), points, cost, in_json(report.text));
}

/// The exit code.
int check_in_json(const ExperimentOptions& options, std::uint64_t max_memory) {
  try {
    const Setup setup = load(options.file, options.changes);
    const Report report = check(setup, max_memory);
    print_json({}, report, setup.points());
    return options.strict && !report.warnings.empty() ? exit_code::bad_input : exit_code::done;
  } catch (const InputError& error) {
    print_json(error.diagnostics(), {}, 0);
    return exit_code::bad_input;
  } catch (const StorageError& error) {
    print_json({{{make_source_text(options.file.string(), ""), 0, 0, 1}, error.what(), {}}}, {}, 0);
    return exit_code::not_written;
  }
}

}  // namespace

void add_check(CLI::App& app, int& exit) {
  CLI::App* verb =
      app.add_subcommand("check", "show every error at once, else the plan and the derived numbers");
  auto options = std::make_shared<ExperimentOptions>();
  options->add_to(*verb);
  auto machine = std::make_shared<MachineOptions>();
  machine->add_memory_to(*verb);
  auto json = std::make_shared<bool>(false);
  verb->add_flag("--json", *json, "print errors, warnings and the plan as JSON");
  verb->callback([options, machine, json, &exit] {
    const std::uint64_t max_memory = machine->settings().max_memory;
    if (*json) {
      exit = check_in_json(*options, max_memory);
      return;
    }
    const Setup setup = load(options->file, options->changes);
    ProgressLine progress("auto");
    progress.planning(setup.points());
    const Report report = check(setup, max_memory);
    progress.clear();
    say(stdout, "{}", report.text);
    tell(report.warnings, options->strict, stdout);
  });
}

}  // namespace rabiline
