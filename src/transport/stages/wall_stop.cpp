#include "transport/stages/wall_stop.hpp"

#include "particle/fate.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

void WallStop::pass(StageContext& context) const {
  const BatchView& b = context.batch.view();
  for (int i = 0; i < b.count; ++i)
    if (b.flying[i] != 0 && b.scratch[i] == wall_mark::of(part)) {
      context.sums[0] += b.weight[i];
      b.flying[i] = 0;
    }
}
void WallStop::list_sums(SumSink& sink) const { sink.fate(fate::stopped, part, 0); }
void WallStop::explain(PlanReport& report) const {
  report.line("{}  {}: stops what met its wall on the way{}", PlanReport::metres(at), report.name_of(part),
              report.reuse);
}
bool WallStop::follows_paths() const { return true; }

}  // namespace rabiline
