// What `check` and `run` do with a model instead of a beamline.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "commands/common.hpp"
#include "storage/motion_file.hpp"

namespace rabiline {
namespace {

std::string_view kind_of(const Model& model) {
  return std::visit([](const auto& any) { return any.kind; }, model);
}
std::string_view meaning_of(const Model& model) {
  return std::visit([](const auto& any) { return any.meaning; }, model);
}

std::string value_at(const ScanAxis& axis, std::size_t i) {
  return axis.dimension ? pretty_quantity(axis.values[i], *axis.dimension) : axis.labels[i];
}

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
  fmt::print("  over {} points of {}, {} to {}\n", points, solved.axis->parameter, value_at(*solved.axis, 0),
             value_at(*solved.axis, points - 1));
  for (const FoundAtPoints& found : findings_of(solved.points)) {
    std::vector<double> values = found.values;
    std::erase_if(values, [](double value) { return std::isnan(value); });
    if (values.empty()) continue;
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    fmt::print("  {:<30} from {:.9g} to {}{}\n", found.name, *least, with_unit(*most, found.unit),
               values.size() == points ? "" : fmt::format(", at {} of the points", values.size()));
  }
}

/// GSL gives up near a place where a force has no bound.
ModelResult solve_point(const SolvedModel& solved, const Model& model) {
  try {
    return std::visit([](const auto& any) { return solve(any); }, model);
  } catch (const std::runtime_error& error) {
    if (!solved.axis) throw ArgumentError(error.what());
    throw ArgumentError(fmt::format("{}, at {} = {}", error.what(), solved.axis->parameter,
                                    value_at(*solved.axis, solved.points.size())));
  }
}

/// Each finding with what is expected of it; of a scan its smallest and largest value.
void print_findings(const SolvedModel& solved) {
  if (solved.axis) return print_ranges(solved);
  for (const Finding& f : solved.points.front().findings)
    fmt::print("  {:<30} {:>15.9g}, {}\n", f.name, f.value, told_of(f));
}

}  // namespace

std::string check_model(const LoadedModel& loaded) {
  const ModelFile& first = loaded.points.front();
  std::string out =
      fmt::format("{}\nmodel      {}: {}\n", first.title, kind_of(first.model), meaning_of(first.model));
  for (const ScanAxis& axis : loaded.axes)
    out += fmt::format("scan       {}: {} to {}, {} points; the numbers below are those of the first\n",
                       axis.parameter, value_at(axis, 0), value_at(axis, axis.values.size() - 1),
                       axis.values.size());
  out += '\n';
  const std::vector<Fact> facts = std::visit([](const auto& any) { return facts_of(any); }, first.model);
  for (const Fact& fact : facts)
    out += fmt::format("{:<10} {:<22} {}\n", fact.name, fact.value, fact.meaning);
  return out;
}

void run_model(const LoadedModel& loaded, const std::filesystem::path& output,
               const std::vector<std::string>& arguments) {
  SolvedModel solved{loaded.points.front().title, std::string(kind_of(loaded.points.front().model))};
  solved.provenance = provenance_of(arguments, loaded.inputs);
  if (!loaded.axes.empty()) solved.axis = loaded.axes.front();
  const auto begin = std::chrono::steady_clock::now();
  for (const ModelFile& point : loaded.points) solved.points.push_back(solve_point(solved, point.model));
  solved.provenance.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  solved.provenance.end_time = now();
  write_motions(solved, output);
  fmt::print("{}: {}, {:.2f} s\n", solved.title, solved.kind, solved.provenance.seconds);
  print_findings(solved);
  fmt::print("wrote {}\n", output.string());
}

}  // namespace rabiline
