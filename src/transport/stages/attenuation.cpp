#include "transport/stages/attenuation.hpp"

#ifndef RABILINE_ISA  // what the host does

#include <cmath>

#include "core/portable_math.hpp"
#include "particle/fate.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

Attenuation stage_of(const GasCell& cell, const StageSite& site) {
  return {{site.part, site.y}, density_of(cell.gas) * cell.cross_section * cell.length};
}

void Attenuation::pass(StageContext& context) const {
  context.sums[0] += kernel::attenuate(context.isa)(*this, context.batch.view());
}
void Attenuation::list_sums(SumSink& sink) const { sink.fate("scattered", part, 0); }
void Attenuation::explain(PlanReport& report) const {
  report.line("{}  {}: gas lets {:.4g} of each weight along the beam pass{}", PlanReport::metres(at),
              report.name_of(part), portable::exp(-depth), report.reuse);
}
/// It changes weights.
bool Attenuation::follows_paths() const { return false; }

}  // namespace rabiline

#else  // its kernel, compiled once for each instruction set

#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {

std::uint64_t attenuate(const Attenuation& a, BatchView& batch) {
  words scattered = words{};
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real vx = load(batch.vx + i), vy = load(batch.vy + i), vz = load(batch.vz + i);
    const real slant = sqrt(fma(vx, vx, fma(vy, vy, vz * vz))) / vy;
    scattered = scattered + let_pass(batch, i, exp(slant * -a.depth));
  }
  return sum_of_lanes(scattered);
}

}  // namespace rabiline::RABILINE_ISA

#endif
