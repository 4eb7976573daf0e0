#include "transport/stages/passage.hpp"

#ifndef RABILINE_ISA  // what the host does

#include "particle/fate.hpp"
#include "transport/cost.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

std::size_t Passage::sums() const { return 1; }
void Passage::pass(StageContext& context) const {
  BatchView& batch = context.batch.view();
  const WallRow others{rivals.data(), static_cast<int>(rivals.size())};
  context.sums[0] += rivals.empty() ? kernel::pass(context.isa)(*this, batch)
                                    : kernel::pass_unless_met(context.isa)(*this, others, batch);
}
void Passage::list_sums(SumSink& sink) const { sink.fate(fate::stopped, part, 0); }
double Passage::y() const { return aperture.y; }
double Passage::cost(double) const { return cost::plane; }
void Passage::explain(PlanReport& report) const {
  report.line("{}  {}: stops what {}{}", PlanReport::metres(aperture.y), report.name_of(part),
              part < 0                ? "meets its wall"
              : aperture.stops_inside ? "hits it"
                                      : "misses its opening",
              report.reuse);
}
bool Passage::follows_paths() const { return true; }
Passage Passage::until(double y) const {
  Passage cut = *this;
  cut.aperture.y = y;
  return cut;
}

}  // namespace rabiline

#else  // its kernel, compiled once for each instruction set

#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {

std::uint64_t pass(const Passage& passage, BatchView& batch) {
  const Aperture& aperture = passage.aperture;
  const bool has_walls = passage.begin < aperture.y && batch.fall != Fall{};
  words stopped = words{};
  for (int i = 0; i < batch.padded; i += lane_count) {
    const OnPlane there = to_plane(aperture.y, batch, i);
    const mask misses_wall =
        has_walls ? ~bulges_out(aperture, passage.begin, broadcast(aperture.y), batch, i) : ~mask{};
    const words through = (words)(inside(aperture, there.x, there.z) & misses_wall),
                flying = load(batch.flying + i);
    stopped = stopped + (load(batch.weight + i) & flying & ~through);
    store(batch.flying + i, flying & through);
  }
  return sum_of_lanes(stopped);
}

std::uint64_t pass_unless_met(const Passage& passage, const WallRow& rivals, BatchView& batch) {
  const Aperture& aperture = passage.aperture;
  words stopped = words{};
  for (int i = 0; i < batch.padded; i += lane_count) {
    const words flying = load(batch.flying + i);
    mask meets = (mask)flying & meets_wall(aperture, passage.begin, broadcast(aperture.y), batch, i);
    if (!any(meets)) continue;
    const real here = place_of_meeting(aperture, passage.begin, aperture.y, meets, batch, i);
    for (int k = 0; k < rivals.count; ++k)
      meets = meets & ~(place_of_meeting(rivals.walls[k], passage.begin, aperture.y, meets, batch, i) < here);
    stopped = stopped + (load(batch.weight + i) & (words)meets);
    store(batch.flying + i, flying & ~(words)meets);
  }
  return sum_of_lanes(stopped);
}

}  // namespace rabiline::RABILINE_ISA

#endif
