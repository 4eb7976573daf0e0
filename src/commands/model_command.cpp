// What `run` does with a model instead of a beamline.
#include <algorithm>
#include <cmath>
#include <vector>

#include "commands/flight.hpp"
#include "commands/stop.hpp"
#include "scan/settings.hpp"
#include "storage/lock.hpp"
#include "storage/safe_file.hpp"

namespace rabiline {
namespace {

std::string with_unit(double value, std::string_view unit) {
  return fmt::format("{:.9g}{}", value, unit == "1" ? "" : fmt::format(" {}", unit));
}

/// "closed form 0.63662", "conserved", "the paper supposes 0".
std::string told_of(const Finding& f) {
  const std::string number = with_unit(f.expected, f.unit);
  switch (f.expectation) {
    case Expectation::closed_form:
      return "closed form " + number;
    case Expectation::conserved:
      return "conserved";
    case Expectation::approximate:
      return "approximately " + number;
    case Expectation::supposed:
      return "the paper supposes " + number;
  }
  return {};
}

/// The smallest and largest value of each finding.
void print_ranges(const SolvedModel& solved) {
  const std::size_t points = solved.points.size();
  say(stdout, "  over {} points of {}, {} to {}\n", points, solved.axis->parameter, value_at(*solved.axis, 0),
      value_at(*solved.axis, points - 1));
  for (const FoundAtPoints& found : findings_of(solved.points)) {
    std::vector<double> values = found.values;
    std::erase_if(values, [](double value) { return std::isnan(value); });
    if (values.empty()) continue;
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    say(stdout, "  {:<30} from {:.9g} to {}{}\n", found.name, *least, with_unit(*most, found.unit),
        values.size() == points ? "" : fmt::format(", at {} of the points", values.size()));
  }
}

/// Each finding with what is expected of it; of a scan its smallest and largest value.
void print_findings(const SolvedModel& solved) {
  if (solved.points.size() > 1) return print_ranges(solved);
  for (const Finding& f : solved.points.front().findings)
    say(stdout, "  {:<30} {:>15.9g}, {}\n", f.name, f.value, told_of(f));
}

}  // namespace

void run_model(const Setup& setup, const std::filesystem::path& output, const FlightOptions& options,
               const std::vector<std::string>& arguments) {
  const Lock lock(output);
  require_no_checkpoint(output);
  watch_signals();
  if (!options.max_time.empty()) stop_after(read_time_argument("--max-time", options.max_time, range::any));
  SolvedModel solved;
  try {
    solved = solve(setup, arguments, &stop_requested());
  } catch (const std::runtime_error& error) {  // a motion that cannot be integrated
    throw ArgumentError(error.what());
  }
  if (options.keep) back_up(output);
  {
    const StoppedAtOnce end("stopped; nothing was written\n");
    write(solved, output);
  }
  say(stdout, "{}{}, {:.2f} s\n", headed(solved.title), solved.kind, solved.provenance.seconds);
  print_findings(solved);
  say(stdout, "wrote {}\n", output.string());
}

}  // namespace rabiline
