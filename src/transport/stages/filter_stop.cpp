#include "transport/stages/filter_stop.hpp"

#include "particle/fate.hpp"
#include "transport/cost.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

std::size_t FilterStop::sums() const { return 1; }
void FilterStop::pass(StageContext& context) const {
  const BatchView& b = context.batch.view();
  for (int i = 0; i < b.count; ++i)
    if (b.flying[i] != 0 && b.level[i] == static_cast<std::uint64_t>(outcome)) {
      context.sums[0] += b.weight[i];
      b.flying[i] = 0;
    }
}
void FilterStop::list_sums(SumSink& sink) const { sink.fate(fate::stopped, part, 0); }
double FilterStop::y() const { return at; }
double FilterStop::cost(double) const { return cost::plane; }
void FilterStop::explain(PlanReport& report) const {
  report.line("{}  {}: stops its share of each weight{}", PlanReport::metres(at), report.name_of(part),
              report.reuse);
}
bool FilterStop::follows_paths() const { return true; }

}  // namespace rabiline
