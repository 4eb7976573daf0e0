#include "transport/stages/chopping.hpp"

#ifndef RABILINE_ISA  // what the host does

#include <cmath>

#include "core/constants.hpp"
#include "particle/fate.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

Chopping stage_of(const Chopper& chopper, const StageSite& site) {
  return {{site.part, site.y}, chopper.open, chopper.frequency, chopper.phase / constants::two_pi};
}

void Chopping::pass(StageContext& context) const {
  context.sums[0] += kernel::chop(context.isa)(*this, context.batch.view());
}
void Chopping::list_sums(SumSink& sink) const { sink.fate(fate::stopped, part, 0); }
void Chopping::explain(PlanReport& report) const {
  const double arrival = frequency * report.flight.time(0, at) + lead, into = arrival - std::floor(arrival);
  report.line(
      "{}  {}: opens at {} for {}; what starts at 0 s with {:.6g} m/s comes {:.3g} of a period after it "
      "opens{}",
      PlanReport::metres(at), report.name_of(part), pretty_quantity(frequency, Dimension::frequency),
      pretty_quantity(open / frequency, Dimension::time), report.flight.speed, into, report.reuse);
}
bool Chopping::follows_paths() const { return true; }

}  // namespace rabiline

#else  // its kernel, compiled once for each instruction set

#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {

std::uint64_t chop(const Chopping& c, BatchView& batch) {
  words stopped = words{};
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real t = load(batch.t + i) + to_plane(c.at, batch, i).dt;
    const real periods = fma(broadcast(c.frequency), t, broadcast(c.lead));
    const words through = (words)(periods - floor(periods) < broadcast(c.open)),
                flying = load(batch.flying + i);
    stopped = stopped + (load(batch.weight + i) & flying & ~through);
    store(batch.flying + i, flying & through);
  }
  return sum_of_lanes(stopped);
}

}  // namespace rabiline::RABILINE_ISA

#endif
