// Fields that turn the velocity: dS/dt = w x S, dv/dt = W x v, dr/dt = v, in a region of touching zones that
// a particle may cross in either direction.
#include "transport/plane_lanes.hpp"
#include "transport/region.hpp"
#include "transport/turn_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

void record(const StepRecorder& recorder, const State& s) {
  const double place[3] = {lane(s.place.x, 0), lane(s.place.y, 0), lane(s.place.z, 0)};
  const double velocity[3] = {lane(s.velocity.x, 0), lane(s.velocity.y, 0), lane(s.velocity.z, 0)};
  const double spin[3] = {lane(s.spin.x, 0), lane(s.spin.y, 0), lane(s.spin.z, 0)};
  recorder.record(recorder.self, lane(s.t, 0), place, velocity, spin);
}

/// Where the lanes of one pack are seen next: at the first plane ahead that they have not crossed yet.
/// A flight that turns back comes to no plane for the first time until it is farther than ever before.
struct Lookout {
  const Region& region;
  const BatchView& batch;
  int row;     // of the pack
  words next;  // the number of the plane
  words level;

  /// The place of each lane's next plane before the number `end`; where there is none, infinity.
  real places(int end) const {
    real y = broadcast(__builtin_inf());
    for (int i = 0; i < lane_count; ++i)
      if (lane(next, i) < static_cast<unsigned long long>(end)) set_lane(y, i, region.seen[lane(next, i)].y);
    return y;
  }
  /// Puts down the state of what has flown forward through planes within its last step. The state there is
  /// that of a shorter step, which is thrown away: looking does not change the path.
  void look(const Stepper& stepper, const State& before, const State& now, real h, mask flying, int end) {
    for (;;) {
      const real y = places(end);
      const mask crosses = flying & (now.place.y >= y);
      if (!any(crosses)) return;
      put(to_edge(stepper, before, h, select(crosses, y, now.place.y)), crosses);
      next = next + select(crosses, broadcast_word(1), words{});
    }
  }
  void put(const State& s, mask chosen) const {
    for (int i = 0; i < lane_count; ++i) {
      if (lane((words)chosen, i) == 0) continue;
      const BatchView& to = region.seen[lane(next, i)];
      const int at = row + i;
      to.x[at] = lane(s.place.x, i);
      to.z[at] = lane(s.place.z, i);
      to.t[at] = lane(s.t, i);
      to.vx[at] = lane(s.velocity.x, i);
      to.vy[at] = lane(s.velocity.y, i);
      to.vz[at] = lane(s.velocity.z, i);
      to.sx[at] = lane(s.spin.x, i);
      to.sy[at] = lane(s.spin.y, i);
      to.sz[at] = lane(s.spin.z, i);
      to.level[at] = to.prepared[at] = lane(level, i);
      to.weight[at] = batch.weight[at];
      to.particle[at] = batch.particle[at];
      to.flying[at] = ~std::uint64_t{0};
    }
  }
};

/// What becomes of lanes in a zone: their state at its edge or wall, and which of these they met.
struct Visit {
  State state;
  mask forward, backwards, wall, gave_up;
};

/// Flies the chosen lanes through one zone until each has left it, hit its wall or flown too long. `looks`:
/// for planes, too.
template <bool looks>
Visit visit(const Region& region, const RegionZone& zone, const real* phases, const State& start, mask chosen,
            Lookout& lookout, const StepRecorder* recorder) {
  const Stepper stepper{zone.field, region.take_off_spin_component, phases};
  const real begin = broadcast(zone.field.begin), end = broadcast(zone.field.end), h = broadcast(zone.step);
  const real wall2 = broadcast(zone.wall_radius * zone.wall_radius);
  const Propagator whole_step = stepper.steps_of(h);
  const real deadline = start.t + region.most_way / sqrt(dot(start.velocity, start.velocity));
  State now = stepper.enter(start), last = now, before = now;
  mask going = chosen;
  real ahead = looks ? min(lookout.places(zone.sights_passed), end) : end;
  Visit v{now, mask{}, mask{}, mask{}, mask{}};
  for (int steps = 1; any(going); ++steps) {
    const State old = now;
    now = stepper.step(whole_step, old);
    if (steps % steps_between_lengths == 0) now.spin = of_unit_length(now.spin);
    const real from_x = now.place.x - zone.wall_x, from_z = now.place.z - zone.wall_z;
    const real from_axis2 = fma(from_x, from_x, from_z * from_z);
    const mask goes_on = (now.place.y >= begin) & (from_axis2 <= wall2) & (now.t < deadline);
    if (any(going & ~(goes_on & (now.place.y < ahead)))) {
      if constexpr (looks) {
        lookout.look(stepper, old, now, h, going, zone.sights_passed);
        ahead = min(lookout.places(zone.sights_passed), end);
      }
      const mask stays = goes_on & (now.place.y < end);
      const mask forward = (now.place.y >= end) & going, backwards = (now.place.y < begin) & going;
      const mask wall = (from_axis2 > wall2) & going & ~forward & ~backwards;
      const mask leaves =
          going & ~stays;  // what met none of these circles for ever, or is no number any more
      before = choose(leaves, old, before);
      last = choose(leaves, now, last);
      v.forward = v.forward | forward;
      v.backwards = v.backwards | backwards;
      v.wall = v.wall | wall;
      v.gave_up = v.gave_up | (leaves & ~forward & ~backwards & ~wall);
      going = going & ~leaves;
    }
    if (recorder != nullptr && lane((words)going, 0) != 0) record(*recorder, stepper.leave(now));
  }
  const mask crossed = v.forward | v.backwards;
  v.state = stepper.leave(last);
  if (any(crossed))
    v.state = choose(crossed, to_edge(stepper, before, h, select(v.forward, end, begin)), v.state);
  v.state = choose(chosen, v.state, start);
  return v;
}

/// Where each lane of a pack is, and how its flight through the region ended.
struct Pack {
  State state;
  words zone;  // index of the zone it is in
  words level;
  words visits;  // of zones, so far
  words end;     // region_end, bin of a caught particle in the upper half
  mask inside;   // still in the region
};

void finish(Pack& pack, mask lanes, words end) {
  pack.end = select(lanes, end, pack.end);
  pack.inside = pack.inside & ~lanes;
}
words code(std::uint64_t base, int number) {
  return broadcast_word(static_cast<unsigned long long>(base) + static_cast<unsigned long long>(number));
}

/// What stands between two zones: it may stop or catch what crosses it either way, and aligns what enters
/// forward.
void cross_edge(const Region& region, int number, mask lanes, mask forward, words particle, Pack& pack) {
  const RegionEdge& edge = region.edges[number];
  const real x = pack.state.place.x, z = pack.state.place.z;
  if (edge.kind == EdgeKind::plate) {
    finish(pack, lanes & ~inside(edge.plate, x, z), code(region_end::stopped_at_edge, number));
  } else if (edge.kind == EdgeKind::screen) {
    const mask hit = lanes & inside(rim_of(edge.screen), x, z), dead = in_dead_area(edge.screen, x, z);
    finish(pack, hit & dead, code(region_end::stopped_at_edge, number));
    finish(pack, hit & ~dead, code(region_end::caught_at_edge, number) | bin_on(edge.screen, x, z) << 32);
  } else if (edge.kind == EdgeKind::align) {
    const real sign = drawn_sign(edge.align, region.key, particle);
    const words bottom = code(0, edge.align.levels - 1);
    pack.state.spin = select(forward, aligned_spin(edge.align, sign), pack.state.spin);
    if (edge.align.levels > 0)
      pack.level = select(forward, select(sign > broadcast(0), words{}, bottom), pack.level);
  }
}

void leave_zone(const Region& region, int zone, mask chosen, const Visit& visit, words particle, Pack& pack) {
  pack.state = visit.state;
  finish(pack, chosen & visit.gave_up, code(region_end::gave_up, 0));
  finish(pack, chosen & visit.wall, code(region_end::wall_of_zone, zone));
  const mask forward = chosen & visit.forward, backwards = chosen & visit.backwards;
  if (zone + 1 == region.zone_count) {
    finish(pack, forward, code(region_end::forward, 0));
  } else if (any(forward)) {
    cross_edge(region, zone, forward, forward, particle, pack);
    pack.zone = select(forward, code(0, zone + 1), pack.zone);
  }
  if (zone == 0) {
    finish(pack, backwards, code(region_end::backwards, 0));
  } else if (any(backwards)) {
    cross_edge(region, zone - 1, backwards, forward, particle, pack);
    pack.zone = select(backwards, code(0, zone - 1), pack.zone);
  }
}

/// The first zone that a lane inside the region is in.
int first_zone(const Pack& pack, int zone_count) {
  for (int zone = 0; zone < zone_count; ++zone)
    if (any(pack.inside & (pack.zone == code(0, zone)))) return zone;
  return 0;
}

Pack load_pack(const BatchView& batch, int i) {
  Pack pack;
  pack.state.t = load(batch.t + i);
  pack.state.place = {load(batch.x + i), broadcast(batch.y), load(batch.z + i)};
  pack.state.velocity = {load(batch.vx + i), load(batch.vy + i), load(batch.vz + i)};
  pack.state.spin = {load(batch.sx + i), load(batch.sy + i), load(batch.sz + i)};
  pack.level = load(batch.level + i);
  pack.zone = pack.visits = pack.end = words{};
  pack.inside = (mask)load(batch.flying + i);
  return pack;
}

/// Puts a pack back, referred to the plane at the region's end: what did not reach it is drawn out straight.
void store_pack(const Region& region, const Pack& pack, BatchView& batch, int i) {
  const State& s = pack.state;
  const mask caught = (pack.end & region_end::caught_at_edge) != words{};
  const real way = broadcast(region.zones[region.zone_count - 1].field.end) - s.place.y;
  const real dt = select(s.velocity.y != broadcast(0), way / s.velocity.y, broadcast(0));
  store(batch.x + i, fma(s.velocity.x, dt, s.place.x));
  store(batch.z + i, fma(s.velocity.z, dt, s.place.z));
  store(batch.t + i, s.t + dt);
  store(batch.vx + i, s.velocity.x);
  store(batch.vy + i, s.velocity.y);
  store(batch.vz + i, s.velocity.z);
  store(batch.sx + i, s.spin.x);
  store(batch.sy + i, s.spin.y);
  store(batch.sz + i, s.spin.z);
  store(batch.slowness + i, select(caught, 1.0 / s.velocity.y, load(batch.slowness + i)));
  store(batch.level + i, pack.level);
  store(batch.prepared + i, pack.level);
  store(batch.scratch + i, pack.end);
}

}  // namespace

void turn(const Region& region, BatchView& batch, const StepRecorder* recorder) {
  for (int i = 0; i < batch.padded; i += lane_count) {
    Pack pack = load_pack(batch, i);
    Lookout lookout{region, batch, i, words{}, words{}};
    const words particle = load(batch.particle + i);
    while (any(pack.inside)) {
      const int zone = first_zone(pack, region.zone_count);
      const mask chosen = pack.inside & (pack.zone == code(0, zone));
      real phases[most_drives];
      for (int k = 0; k < region.zones[zone].field.drives; ++k)
        phases[k] = oscillator_phase(region.zones[zone].field.drive[k], region.key, particle);
      const StepRecorder* records = i == 0 && lane((words)chosen, 0) != 0 ? recorder : nullptr;
      lookout.level = pack.level;
      const auto visits = region.sight_count > 0 ? visit<true> : visit<false>;
      const Visit v = visits(region, region.zones[zone], phases, pack.state, chosen, lookout, records);
      leave_zone(region, zone, chosen, v, particle, pack);
      pack.visits = pack.visits + select(chosen, broadcast_word(1), words{});
      finish(pack, pack.inside & (pack.visits >= broadcast_word(region.most_visits)),
             code(region_end::gave_up, 0));
      if (records != nullptr) record(*records, pack.state);
    }
    store_pack(region, pack, batch, i);
  }
  batch.y = region.zones[region.zone_count - 1].field.end;
}

}  // namespace rabiline::RABILINE_ISA
