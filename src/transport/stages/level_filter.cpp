#include "transport/stages/level_filter.hpp"

#include <cmath>

#include "particle/fate.hpp"
#include "transport/cost.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

std::size_t LevelFilter::sums() const { return 1; }
void LevelFilter::pass(StageContext& context) const {
  BatchView& b = context.batch.view();
  b.up = false;
  for (int i = 0; i < b.count; ++i) {
    if (b.flying[i] == 0) continue;
    const auto kept =
        static_cast<std::uint64_t>(std::floor(static_cast<double>(b.weight[i]) * passes[b.level[i]]));
    context.sums[0] += b.weight[i] - kept;
    b.weight[i] = kept;
    if (kept == 0) b.flying[i] = 0;
  }
}
void LevelFilter::list_sums(SumSink& sink) const { sink.fate(fate::stopped, part, 0); }
double LevelFilter::y() const { return at; }
double LevelFilter::cost(double) const { return cost::plane; }
void LevelFilter::explain(PlanReport& report) const {
  report.line("{}  {}: lets {} named level{} through and treats the others as its `down` says{}",
              PlanReport::metres(at), report.name_of(part), named, named == 1 ? "" : "s", report.reuse);
  if (!report.why_one_by_one.empty())
    report.line("{:>16}scan points behind it are flown one by one: {}", "", report.why_one_by_one);
}
/// It changes weights.
bool LevelFilter::follows_paths() const { return false; }

}  // namespace rabiline
