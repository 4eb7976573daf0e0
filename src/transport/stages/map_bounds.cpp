#include "transport/stages/map_bounds.hpp"

#ifndef RABILINE_ISA  // what the host does

#include "particle/fate.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

double MapBounds::cost(double) const { return 20 * cost::plane; }
void MapBounds::pass(StageContext& context) const {
  context.sums[0] += kernel::keep_in_map(context.isa)(*this, context.batch.view());
}
void MapBounds::list_sums(SumSink& sink) const { sink.fate(fate::left_map, part, 0); }
void MapBounds::explain(PlanReport& report) const {
  report.line("{}  {}: ends what leaves its map up to {:.4g} m{}", PlanReport::metres(at),
              report.name_of(part), end, report.reuse);
}
bool MapBounds::follows_paths() const { return true; }

}  // namespace rabiline

#else  // its kernel, compiled once for each instruction set

#include "field/lane_maths.hpp"
#include "field/shaped_field.hpp"
#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {

std::uint64_t keep_in_map(const MapBounds& bounds, BatchView& batch) {
  constexpr int places = 64;
  constexpr double inside = 1e-9;  // both ends may be those of the map
  words left = words{};
  for (int i = 0; i < batch.padded; i += lane_count) {
    const words flying = load(batch.flying + i);
    if (!any((mask)flying)) continue;
    mask out{};
    for (int k = 0; k <= places; ++k) {
      const double share = k == 0 ? inside : k == places ? 1 - inside : static_cast<double>(k) / places;
      const double y = bounds.at + share * (bounds.end - bounds.at);
      const OnPlane there = to_plane(y, batch, i);
      out = out | (is_lost<LaneMaths>(bounds.map, there.x, broadcast(y), there.z) > broadcast(0));
    }
    left = left + (load(batch.weight + i) & flying & (words)out);
    store(batch.flying + i, flying & ~(words)out);
  }
  return sum_of_lanes(left);
}

}  // namespace rabiline::RABILINE_ISA

#endif
