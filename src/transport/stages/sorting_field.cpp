#include "transport/stages/sorting_field.hpp"

#include "particle/fate.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

std::size_t SortingField::sums() const { return 1; }
void SortingField::pass(StageContext& context) const {
  BatchView& batch = context.batch.view();
  kernel::turn(context.isa)(view_of(region, context.key), batch, context.recorder);
  for (int i = 0; i < batch.count; ++i) {
    if (batch.flying[i] == 0 || (batch.scratch[i] & 0xffffffffULL) == region_end::forward) continue;
    context.sums[0] += batch.weight[i];
    batch.flying[i] = 0;
  }
}
void SortingField::list_sums(SumSink& sink) const { sink.fate(fate::stopped, part, 0); }
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
