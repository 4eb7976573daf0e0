#include "transport/stages/exit.hpp"

#include "particle/fate.hpp"
#include "transport/cost.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

std::size_t Exit::sums() const { return 1; }
/// The weights of a batch add up to less than 2^64.
void Exit::pass(StageContext& context) const {
  BatchView& batch = context.batch.view();
  std::uint64_t passed = 0;
  for (int i = 0; i < batch.count; ++i) {
    passed += batch.weight[i] & batch.flying[i];
    batch.flying[i] = 0;
  }
  context.sums[0] += passed;
}
void Exit::list_sums(SumSink& sink) const { sink.fate(fate::passed, no_part, 0); }
double Exit::y() const { return behind_everything; }
double Exit::cost(double) const { return cost::plane; }
void Exit::explain(PlanReport& report) const {
  report.line("            what still flies has passed{}", report.reuse);
}
bool Exit::follows_paths() const { return true; }

}  // namespace rabiline
