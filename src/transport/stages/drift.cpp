#include "transport/stages/drift.hpp"

#ifndef RABILINE_ISA  // what the host does

#include "transport/cost.hpp"
#include "transport/plan_report.hpp"

namespace rabiline {

std::size_t Drift::sums() const { return 0; }
void Drift::pass(StageContext& context) const { kernel::drift(context.isa)(end, context.batch.view()); }
void Drift::list_sums(SumSink&) const {}
double Drift::y() const { return end; }
double Drift::cost(double) const { return cost::plane; }
void Drift::explain(PlanReport& report) const {
  report.line("{}  straight to here{}", PlanReport::metres(end), report.reuse);
}
bool Drift::follows_paths() const { return true; }

}  // namespace rabiline

#else  // its kernel, compiled once for each instruction set

#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {

void drift(double y, BatchView& batch) {
  if (y == batch.y) return;
  for (int i = 0; i < batch.padded; i += lane_count) {
    const OnPlane there = to_plane(y, batch, i);
    store(batch.x + i, there.x);
    store(batch.z + i, there.z);
    store(batch.t + i, load(batch.t + i) + there.dt);
    fall_for(there.dt, batch, i);
  }
  batch.y = y;
}

}  // namespace rabiline::RABILINE_ISA

#endif
