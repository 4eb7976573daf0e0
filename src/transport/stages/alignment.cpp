#include "transport/stages/alignment.hpp"

#ifndef RABILINE_ISA  // what the host does

#include "transport/cost.hpp"
#include "transport/plan_report.hpp"

namespace rabiline {

std::size_t Alignment::sums() const { return 0; }
void Alignment::pass(StageContext& context) const {
  kernel::align(context.isa)(*this, context.key, context.batch.view());
}
void Alignment::list_sums(SumSink&) const {}
double Alignment::y() const { return at; }
double Alignment::cost(double) const { return cost::plane; }
void Alignment::explain(PlanReport& report) const {
  report.tip = 0;
  report.line("{}  {}: moments along the field with probability {:g}{}", PlanReport::metres(at),
              report.name_of(part), probability, report.reuse);
}
/// Levels are prepared anew.
bool Alignment::follows_paths() const { return false; }

}  // namespace rabiline

#else  // its kernel, compiled once for each instruction set

#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {

void align(const Alignment& alignment, const RandomKey& key, BatchView& batch) {
  batch.up = false;
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real sign = drawn_sign(alignment, key, load(batch.particle + i));
    const mask flying = (mask)load(batch.flying + i);
    const Vector spin = aligned_spin(alignment, sign);
    store(batch.sx + i, select(flying, spin.x, load(batch.sx + i)));
    store(batch.sy + i, select(flying, spin.y, load(batch.sy + i)));
    store(batch.sz + i, select(flying, spin.z, load(batch.sz + i)));
    if (alignment.levels == 0) continue;
    const words along = broadcast_word(static_cast<unsigned long long>(alignment.along)),
                against = broadcast_word(static_cast<unsigned long long>(alignment.against));
    const words level = select(flying, select(sign > broadcast(0), along, against), load(batch.level + i));
    store(batch.level + i, level);
    store(batch.prepared + i, select(flying, level, load(batch.prepared + i)));
  }
}

}  // namespace rabiline::RABILINE_ISA

#endif
