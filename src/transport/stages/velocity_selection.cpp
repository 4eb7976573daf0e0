#include "transport/stages/velocity_selection.hpp"

#ifndef RABILINE_ISA  // what the host does

#include "particle/fate.hpp"
#include "particle/species.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

VelocitySelection stage_of(const VelocitySelector& selector, const StageSite& site) {
  return {{site.part, site.y},
          speed_of(selector.speed, site.species.mass),
          selector.resolution,
          selector.transmission};
}

void VelocitySelection::pass(StageContext& context) const {
  context.sums[0] += kernel::select_velocities(context.isa)(*this, context.batch.view());
}
void VelocitySelection::list_sums(SumSink& sink) const { sink.fate(fate::stopped, part, 0); }
void VelocitySelection::explain(PlanReport& report) const {
  report.line("{}  {}: passes {:.4g} at {:.6g} m/s, half of it at {:.6g} and {:.6g} m/s{}",
              PlanReport::metres(at), report.name_of(part), transmission, speed, speed / (1 + resolution / 2),
              speed / (1 - resolution / 2), report.reuse);
}
/// It changes weights.
bool VelocitySelection::follows_paths() const { return false; }

}  // namespace rabiline

#else  // its kernel, compiled once for each instruction set

#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {

std::uint64_t select_velocities(const VelocitySelection& s, BatchView& batch) {
  words stopped = words{};
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real off = abs(s.speed * load(batch.slowness + i) - 1.0);  // of the nominal wavelength
    const real share = s.transmission * max(broadcast(0), 1.0 - off / s.resolution);
    stopped = stopped + let_pass(batch, i, share);
  }
  return sum_of_lanes(stopped);
}

}  // namespace rabiline::RABILINE_ISA

#endif
