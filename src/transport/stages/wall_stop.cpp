#include "transport/stages/wall_stop.hpp"

#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

void WallStop::pass(StageContext& context) const {
  const BatchView& b = context.batch.view();
  const std::uint64_t mark = ending == fate::left_map ? wall_mark::of_map : wall_mark::of(part);
  for (int i = 0; i < b.count; ++i)
    if (b.flying[i] != 0 && b.scratch[i] == mark) {
      context.sums[0] += b.weight[i];
      b.flying[i] = 0;
    }
}
void WallStop::list_sums(SumSink& sink) const { sink.fate(ending, part, 0); }
void WallStop::explain(PlanReport& report) const {
  if (ending == fate::left_map)
    report.line("{}  ends what left its map on the way{}", PlanReport::metres(at), report.reuse);
  else
    report.line("{}  {}: stops what met its wall on the way{}", PlanReport::metres(at), report.name_of(part),
                report.reuse);
}
bool WallStop::follows_paths() const { return true; }

}  // namespace rabiline
