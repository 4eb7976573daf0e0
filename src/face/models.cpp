#include "face/models.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include "scan/resolved.hpp"

namespace rabiline {
namespace {

std::string_view kind_of(const Model& model) {
  return std::visit([](const auto& any) { return any.kind; }, model);
}
std::string_view meaning_of(const Model& model) {
  return std::visit([](const auto& any) { return any.meaning; }, model);
}

/// GSL gives up near a place where a force has no bound.
ModelResult solve_point(const SolvedModel& solved, const Model& model) {
  try {
    return std::visit([](const auto& any) { return solve(any); }, model);
  } catch (const std::runtime_error& error) {
    if (!solved.axis) throw;
    throw std::runtime_error(fmt::format("{}, at {} = {}", error.what(), solved.axis->parameter,
                                         value_at(*solved.axis, solved.points.size())));
  }
}

}  // namespace

std::string explain(const LoadedModel& loaded) {
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

SolvedModel solve_all(const LoadedModel& loaded, const std::function<void()>& between) {
  SolvedModel solved{loaded.points.front().title, std::string(kind_of(loaded.points.front().model))};
  if (!loaded.axes.empty()) solved.axis = loaded.axes.front();
  solved.parameters = resolved_parameters(loaded.points);
  for (const ModelFile& point : loaded.points) {
    between();
    solved.points.push_back(solve_point(solved, point.model));
  }
  return solved;
}

}  // namespace rabiline
