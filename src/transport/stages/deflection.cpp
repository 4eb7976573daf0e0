#include "transport/stages/deflection.hpp"

#ifndef RABILINE_ISA  // what the host does

#include <cmath>

#include "particle/fate.hpp"
#include "transport/cost.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

std::size_t Deflection::sums() const { return 1; }
void Deflection::pass(StageContext& context) const {
  context.sums[0] += kernel::deflect(context.isa)(*this, context.batch.view());
}
void Deflection::list_sums(SumSink& sink) const { sink.fate(fate::stopped, part, 0); }
double Deflection::y() const { return begin; }
double Deflection::cost(double) const { return cost::plane; }
bool Deflection::follows_paths() const { return true; }
Deflection Deflection::piece(double from, double to) const {
  Deflection cut = *this;
  cut.begin = from;
  cut.end = to;
  return cut;
}

void Deflection::explain(PlanReport& report) const {
  const auto metres = [](double x) { return pretty_quantity(x, Dimension::length); };
  const std::string name = report.name_of(part);
  report.line("{}  {}: deflects up to {}{}", PlanReport::metres(begin), name, PlanReport::metres(end),
              report.reuse);
  report.on_axis.clear();
  const double speed = report.flight.speed_between(begin, end), stay = (end - begin) / speed,
               bent = std::abs(acceleration) * stay * stay / 2;
  report.line("{:>16}m = I goes by {} there", "", metres(bent));
  const double room = 2 * (std::abs(along_z) > std::abs(along_x) ? half_z : half_x);
  if (!has_gap || bent <= room) return;
  const double stops = begin + (end - begin) * std::sqrt(room / 2 / bent);
  if (levels > 0 && levels % 2 == 0 && bent > room * (levels - 1))
    report.warn(
        name, "gradient",
        fmt::format("`{}` pushes every level into its walls: m = I by {} within a gap of {} at {:.4g} m/s, "
                    "and stops it at "
                    "about {:.3g} m; nothing so slow can arrive",
                    name, metres(bent), metres(room), speed, stops));
  else
    report.warn(
        name, "gradient",
        fmt::format("`{}` pushes the outer levels into its walls: m = I by {} within a gap of {} at {:.0f} "
                    "m/s, and stops them at about {:.3g} m",
                    name, metres(bent), metres(room), speed, stops));
}

}  // namespace rabiline

#else  // its kernel, compiled once for each instruction set

#include "transport/plane_lanes.hpp"
#include "transport/stages/wall_stop.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

/// Whether a coordinate stays between walls on q + v t + a t^2/2 for 0 <= t <= T: at the end, and where it
/// turns round.
RABILINE_LANES mask stays_between(real q, real v, real a, real end_time, double centre, double half) {
  const auto inside = [&](real t) { return abs(fma(fma(0.5 * a, t, v), t, q - centre)) <= broadcast(half); };
  const real turn = select(a != broadcast(0), -v / a, broadcast(-1));
  const mask turns = (turn > broadcast(0)) & (turn < end_time);
  return inside(end_time) & (inside(turn) | ~turns);
}

/// Which of the chosen lanes meet the chamber on their parabola, and no wall of the gap before.
RABILINE_LANES mask meets_chamber(const Deflection& d, mask chosen, real x, real z, real vx, real vz,
                                  const Acceleration& along, real time) {
  const auto leaves_chamber = [&](real share) {
    const real t = share * time, gx = t * t * along.x, gz = t * t * along.z;
    const real end_x = fma(fma(0.5 * along.x, t, vx), t, x), end_z = fma(fma(0.5 * along.z, t, vz), t, z);
    return max(fma(end_x, end_x, end_z * end_z), Parabola{x, z, vx * t, vz * t, gx, gz}.farthest2()) >
           broadcast(d.chamber * d.chamber);
  };
  const real whole = broadcast(1);
  const mask meets = chosen & leaves_chamber(whole);
  if (!d.has_gap || !any(meets)) return meets;
  const auto leaves_gap = [&](real share) {
    return ~(stays_between(x, vx, along.x, share * time, d.x0, d.half_x) &
             stays_between(z, vz, along.z, share * time, d.z0, d.half_z));
  };
  const real nothing = broadcast(0);
  const mask both = meets & leaves_gap(whole);
  return meets &
         ~(both & (first_place(nothing, whole, leaves_gap) < first_place(nothing, whole, leaves_chamber)));
}

}  // namespace

std::uint64_t deflect(const Deflection& d, BatchView& batch) {
  words stopped = words{};
  for (int i = 0; i < batch.padded; i += lane_count) {
    const words flying = load(batch.flying + i);
    // The part of the moment along z: m/I of a level, S_z of a vector.
    const real part =
        d.levels > 0 ? fma(number_of(load(batch.level + i)), broadcast(-2.0 / (d.levels - 1)), broadcast(1))
                     : load(batch.sz + i);
    const real a = select((mask)flying, part * d.acceleration, broadcast(0));
    const Acceleration along{a * d.along_x + batch.fall.x, a * d.along_z + batch.fall.z};
    const OnPlane there = to_plane(d.end, batch, i, along);
    const real vx = load(batch.vx + i), vz = load(batch.vz + i);
    mask in_chamber = ~mask{};
    if (d.chamber < __builtin_inf()) {
      in_chamber =
          ~meets_chamber(d, (mask)flying, load(batch.x + i), load(batch.z + i), vx, vz, along, there.dt);
      store(batch.scratch + i, select(in_chamber, words{}, broadcast_word(wall_mark::of_chamber)));
    }
    if (d.has_gap) {
      const mask free = (stays_between(load(batch.x + i), vx, along.x, there.dt, d.x0, d.half_x) &
                         stays_between(load(batch.z + i), vz, along.z, there.dt, d.z0, d.half_z)) |
                        ~in_chamber;
      stopped = stopped + (load(batch.weight + i) & flying & ~(words)free);
      store(batch.flying + i, flying & (words)free);
    }
    store(batch.x + i, there.x);
    store(batch.z + i, there.z);
    store(batch.vx + i, fma(along.x, there.dt, vx));
    store(batch.vz + i, fma(along.z, there.dt, vz));
    store(batch.t + i, load(batch.t + i) + there.dt);
  }
  batch.y = d.end;
  return sum_of_lanes(stopped);
}

}  // namespace rabiline::RABILINE_ISA

#endif
