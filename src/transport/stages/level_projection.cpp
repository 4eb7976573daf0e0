#include "transport/stages/level_projection.hpp"

#include <numeric>

#include "transport/plan_report.hpp"

namespace rabiline {
namespace {

std::string how_reweighted(const PlanReport& report) {
  if (report.slowness_cells > 0)
    return fmt::format("by moments of the slowness in {} cells", report.slowness_cells);
  if (report.most_nodes == 0) return fmt::format("one by one: {}", report.why_one_by_one);
  return report.fewest_nodes == report.most_nodes
             ? fmt::format("between {} frequencies", report.most_nodes)
             : fmt::format("between {} frequencies, for slower particles up to {}", report.fewest_nodes,
                           report.most_nodes);
}

}  // namespace

std::size_t LevelProjection::sums() const { return 0; }
void LevelProjection::pass(StageContext& context) const {
  require_followed(kernel::collapse(context.isa)(spins.view(context.key), part, context.batch.view()));
}
void LevelProjection::list_sums(SumSink&) const {}
double LevelProjection::y() const { return at; }
double LevelProjection::cost(double speed) const { return spins.cost(speed); }
void LevelProjection::explain(PlanReport& report) const {
  const bool along_z = spins.axis == UnitVector{};
  if (spins.filters.empty())
    report.line(
        "            {}: each particle is in one level{} from here on, {}{}", report.name_of(part),
        along_z ? ""
                : fmt::format(" along [{:.4g}, {:.4g}, {:.4g}]", spins.axis.x, spins.axis.y, spins.axis.z),
        split ? "all are followed with their shares of its weight" : "drawn by its probability",
        report.reuse);
  for (const FilteredZones& next : spins.filters) {
    for (const SpinZone& zone : next.zones) explain_zone(zone, report);
    next.filter.explain(report);
  }
  if (report.reweightings > 1)
    report.line("{:>16}its paths in {} {} are flown once and reweighted for {} settings {}", "",
                report.levels_found, spins.filters.empty() ? "levels" : "outcomes", report.reweightings,
                how_reweighted(report));
  if (report.of_atom && !report.on_axis.empty()) {
    report.on_axis.resize(static_cast<std::size_t>(spins.levels));
    std::iota(report.on_axis.begin(), report.on_axis.end(), 0);
  }
  if (spins.way != nullptr) report.line("{:>16}its levels are {}", "", describe(*spins.way));
  for (const SpinZone& zone : spins.zones) explain_zone(zone, report);
  report.tell_driven(part);
}
/// It draws a level along each path.
bool LevelProjection::follows_paths() const { return true; }

}  // namespace rabiline
