#include "transport/stages/attenuation.hpp"

#ifndef RABILINE_ISA  // what the host does

#include <algorithm>

#include "core/portable_math.hpp"
#include "particle/fate.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

Attenuation stage_of(const GasCell& cell, const StageSite& site) {
  return {{site.part, site.y}, density_of(cell.gas) * cell.cross_section * cell.length, cell.length};
}

void Attenuation::pass(StageContext& context) const {
  const WallRow around{walls.data(), static_cast<int>(walls.size())};
  context.sums[0] += kernel::attenuate(context.isa)(*this, around, context.batch.view());
}
void Attenuation::list_sums(SumSink& sink) const { sink.fate("scattered", part, 0); }
void Attenuation::explain(PlanReport& report) const {
  report.line("{}  {}: gas that {:.4g} of what flies along the axis passes{}", PlanReport::metres(at),
              report.name_of(part), portable::exp(-depth), report.reuse);
}
/// It changes weights.
bool Attenuation::follows_paths() const { return false; }
Attenuation Attenuation::between(double from, double to) const {
  constexpr double slack = 1e-12;  // [m] places closer than that are one
  if (from <= at + slack && to >= at + length - slack) return *this;
  Attenuation cut = *this;
  cut.at = std::max(from, at);
  cut.length = std::max(std::min(to, at + length) - cut.at, 0.0);
  cut.depth = depth * (cut.length / length);
  return cut;
}

}  // namespace rabiline

#else  // its kernel, compiled once for each instruction set

#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {

namespace {

/// The path over the length along the beam, for a flight whose velocity is that which it has at y.
RABILINE_LANES real slant_at(real y, const BatchView& batch, int i) {
  const real vy = load(batch.vy + i), slowness = load(batch.slowness + i), dt = (y - batch.y) * slowness;
  const real vx = fma(broadcast(batch.fall.x), dt, load(batch.vx + i)),
             vz = fma(broadcast(batch.fall.z), dt, load(batch.vz + i));
  return sqrt(fma(vx, vx, fma(vy, vy, vz * vz))) * slowness;
}
/// The mean over a share of the gas: of a parabola by the rule of Gauss and Legendre with four places.
RABILINE_LANES real mean_slant(const Attenuation& a, real share, const BatchView& batch, int i) {
  if (batch.fall == Fall{}) return slant_at(broadcast(batch.y), batch, i);
  constexpr double place[2] = {0.33998104358485626, 0.86113631159405258},
                   weight[2] = {0.32607257743127307, 0.17392742256872693};
  real mean = broadcast(0);
  for (int k = 0; k < 2; ++k)
    for (const double sign : {-1.0, 1.0})
      mean = fma(broadcast(weight[k]),
                 slant_at(share * (0.5 * a.length * (1 + sign * place[k])) + a.at, batch, i), mean);
  return mean;
}
/// The share of the gas that lies before the first wall.
RABILINE_LANES real share_before(const WallRow& row, const Attenuation& a, const BatchView& batch, int i) {
  const double end = a.at + a.length;
  const mask flying = (mask)load(batch.flying + i);
  real share = broadcast(1);
  for (int k = 0; k < row.count; ++k) {
    const real place = place_of_meeting(row.walls[k], a.at, end, flying, batch, i);
    share = min(share, select(place < end, (place - a.at) * (1 / a.length), broadcast(1)));
  }
  return share;
}

}  // namespace

std::uint64_t attenuate(const Attenuation& a, const WallRow& walls, BatchView& batch) {
  words scattered = words{};
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real share = share_before(walls, a, batch, i);
    scattered = scattered + let_pass(batch, i, exp(mean_slant(a, share, batch, i) * (share * -a.depth)));
  }
  return sum_of_lanes(scattered);
}

}  // namespace rabiline::RABILINE_ISA

#endif
