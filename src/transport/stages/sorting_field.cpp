#include "transport/stages/sorting_field.hpp"

#include <algorithm>
#include <cmath>

#include "field/shaped_field.hpp"
#include "particle/fate.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

std::size_t SortingField::sums() const { return 1; }
void SortingField::pass(StageContext& context) const {
  BatchView& batch = context.batch.view();
  kernel::turn(context.isa)(view_of(region, context.key), batch, context.recorder);
  if (axis_behind) {
    batch.up = false;
    std::fill_n(batch.sx, batch.padded, axis_behind->x);
    std::fill_n(batch.sy, batch.padded, axis_behind->y);
    std::fill_n(batch.sz, batch.padded, axis_behind->z);
  }
  for (int i = 0; i < batch.count; ++i) {
    if (batch.flying[i] == 0) continue;
    const std::uint64_t end = batch.scratch[i] & 0xffffffffULL;
    batch.scratch[i] = 0;
    if (end == region_end::forward) continue;
    if (end == region_end::left_map) {
      batch.scratch[i] = wall_mark::of_map;
      continue;
    }
    if (end >= region_end::at_wall) {
      const int met = part_of_wall(region, end - region_end::at_wall);
      if (met != part) {
        batch.scratch[i] = wall_mark::of(met);
        continue;
      }
    }
    context.sums[0] += batch.weight[i];
    batch.flying[i] = 0;
  }
}
void SortingField::list_sums(SumSink& sink) const { sink.fate(fate::stopped, part, 0); }
std::vector<WallStop> SortingField::stops_behind() const {
  std::vector<WallStop> stops;
  const double end = region.zones.back().field.end;
  for (std::size_t wall = 0; wall < region.zones.size() + region.channels.size() + region.gaps.size();
       ++wall) {
    if (wall < region.zones.size() && !std::isfinite(region.zones[wall].wall_radius)) continue;
    const WallStop stop{{part_of_wall(region, wall), end}};
    if (stop.part != part && std::ranges::find(stops, stop) == stops.end()) stops.push_back(stop);
  }
  if (std::ranges::any_of(region.shaped, nothing_may_leave))
    stops.push_back({{no_part, end}, fate::left_map});
  return stops;
}
double SortingField::y() const { return region.y(); }
double SortingField::cost(double speed) const { return region.cost(speed); }
void SortingField::explain(PlanReport& report) const {
  report.line("{}  {}: pushes each level by its gradient, to {}{}", PlanReport::metres(y()),
              report.name_of(part), PlanReport::metres(region.zones.back().field.end), report.reuse);
  explain_levels(region, report);
  report.on_axis.clear();
}
bool SortingField::follows_paths() const { return true; }

}  // namespace rabiline
