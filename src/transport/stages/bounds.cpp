#include "transport/stages/bounds.hpp"

#ifndef RABILINE_ISA  // what the host does

#include "particle/fate.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

double Bounds::cost(double) const { return 20 * cost::plane; }
void Bounds::pass(StageContext& context) const {
  const FlightRange range{at, end, {rivals.data(), static_cast<int>(rivals.size())}};
  const auto* gap = std::get_if<RegionGap>(&space);
  BatchView& batch = context.batch.view();
  context.sums[0] += gap != nullptr
                         ? kernel::keep_in_gap(context.isa)(*gap, range, batch)
                         : kernel::keep_in_map(context.isa)(std::get<ShapedTerm>(space), range, batch);
}
void Bounds::list_sums(SumSink& sink) const {
  sink.fate(std::holds_alternative<RegionGap>(space) ? fate::stopped : fate::left_map, part, 0);
}
void Bounds::explain(PlanReport& report) const {
  report.line(
      "{}  {}: {} up to {:.4g} m{}", PlanReport::metres(at), report.name_of(part),
      std::holds_alternative<RegionGap>(space) ? "stops what leaves its gap" : "ends what leaves its map",
      end, report.reuse);
}
bool Bounds::follows_paths() const { return true; }
Bounds Bounds::until(double y) const {
  Bounds cut = *this;
  cut.end = y;
  return cut;
}

}  // namespace rabiline

#else  // its kernels, compiled once for each instruction set

#include "field/lane_maths.hpp"
#include "field/shaped_field.hpp"
#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

/// `outside`: which lanes are, at a place (x, y, z).
template <class Outside>
std::uint64_t end_what_leaves(const FlightRange& range, BatchView& batch, Outside outside) {
  constexpr int places = 64;
  constexpr double inside = 1e-9;  // both ends may be those of the space
  words left = words{};
  for (int i = 0; i < batch.padded; i += lane_count) {
    const words flying = load(batch.flying + i);
    if (!any((mask)flying)) continue;
    mask out{}, ended_before{};
    for (int k = 0; k <= places; ++k) {
      const double share = k == 0 ? inside : k == places ? 1 - inside : static_cast<double>(k) / places;
      const double y = range.begin + share * (range.end - range.begin);
      const OnPlane there = to_plane(y, batch, i);
      const mask leaves = outside(there.x, broadcast(y), there.z) & (mask)flying & ~out & ~ended_before;
      if (!any(leaves)) continue;
      for (int r = 0; r < range.rivals.count; ++r)
        ended_before =
            ended_before | (leaves & meets_wall(range.rivals.walls[r], range.begin, broadcast(y), batch, i));
      out = out | (leaves & ~ended_before);
    }
    left = left + (load(batch.weight + i) & flying & (words)out);
    store(batch.flying + i, flying & ~(words)out);
  }
  return sum_of_lanes(left);
}

}  // namespace

std::uint64_t keep_in_gap(const RegionGap& gap, const FlightRange& range, BatchView& batch) {
  return end_what_leaves(range, batch, [&](real x, real, real z) { return ~is_in(gap, x, z); });
}
std::uint64_t keep_in_map(const ShapedTerm& map, const FlightRange& range, BatchView& batch) {
  return end_what_leaves(
      range, batch, [&](real x, real y, real z) { return is_lost<LaneMaths>(map, x, y, z) > broadcast(0); });
}

}  // namespace rabiline::RABILINE_ISA

#endif
