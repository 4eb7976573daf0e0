#include "transport/stages/precession.hpp"

#ifndef RABILINE_ISA  // what the host does

#include "transport/plan_report.hpp"
#include "transport/spin_path.hpp"

namespace rabiline {

std::size_t Precession::sums() const { return 0; }
void Precession::pass(StageContext& context) const {
  kernel::precess(context.isa)(zones.data(), static_cast<int>(zones.size()), context.key,
                               context.batch.view());
}
void Precession::list_sums(SumSink&) const {}
double Precession::y() const { return zones.back().end; }
double Precession::cost(double speed) const { return cost_of(zones, speed); }
void Precession::explain(PlanReport& report) const {
  report.line("            spins are carried to the next plane{}", report.reuse);
  for (const SpinZone& zone : zones) explain_zone(zone, report);
}
/// Fields may change the levels of a path.
bool Precession::follows_paths() const { return false; }

}  // namespace rabiline

#else  // its kernel, compiled once for each instruction set

#include "transport/spin_lanes.hpp"

namespace rabiline::RABILINE_ISA {

void precess(const SpinZone* zones, int zone_count, const RandomKey& key, BatchView& batch) {
  batch.up = false;
  for (int i = 0; i < batch.padded; i += lane_count) {
    const mask flying = (mask)load(batch.flying + i);
    const Vector s = spin_after(zones, zone_count, key, batch, i, load(batch.slowness + i));
    store(batch.sx + i, select(flying, s.x, load(batch.sx + i)));
    store(batch.sy + i, select(flying, s.y, load(batch.sy + i)));
    store(batch.sz + i, select(flying, s.z, load(batch.sz + i)));
  }
}

}  // namespace rabiline::RABILINE_ISA

#endif
