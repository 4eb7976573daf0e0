// Fields that turn the velocity: dS/dt = w x S, dv/dt = W x v, dr/dt = v, in a region of touching zones that
// a particle may cross in either direction.
#include "transport/march_lanes.hpp"
#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

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
    pack.state.spin = select(forward, aligned_spin(edge.align, sign), pack.state.spin);
    if (edge.align.levels > 0)
      pack.level =
          select(forward, select(sign > broadcast(0), code(0, edge.align.along), code(0, edge.align.against)),
                 pack.level);
  }
}

void leave_zone(const Region& region, int zone, mask chosen, const Visit& visit, words particle, Pack& pack) {
  pack.state = visit.state;
  finish(pack, chosen & visit.gave_up, code(region_end::gave_up, 0));
  finish(pack, chosen & visit.left_map, code(region_end::left_map, 0));
  finish(pack, chosen & visit.wall, visit.met + region_end::at_wall);
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

/// Whether particles may get another level in it.
bool aligns(const Region& region) {
  for (int edge = 0; edge + 1 < region.zone_count; ++edge)
    if (region.edges[edge].kind == EdgeKind::align) return true;
  return false;
}

/// Puts a pack back, referred to the plane at the region's end: what did not reach it is drawn out in free
/// flight.
void store_pack(const Region& region, const Pack& pack, BatchView& batch, int i) {
  const State& s = pack.state;
  const real way = broadcast(region.zones[region.zone_count - 1].field.end) - s.place.y;
  const real dt = select(s.velocity.y != broadcast(0), way / s.velocity.y, broadcast(0));
  const Fall& fall = batch.fall;
  store(batch.x + i, fma(fma(broadcast(0.5 * fall.x), dt, s.velocity.x), dt, s.place.x));
  store(batch.z + i, fma(fma(broadcast(0.5 * fall.z), dt, s.velocity.z), dt, s.place.z));
  store(batch.t + i, s.t + dt);
  store(batch.vx + i, s.velocity.x);
  store(batch.vy + i, s.velocity.y);
  store(batch.vz + i, s.velocity.z);
  fall_for(dt, batch, i);
  store(batch.sx + i, s.spin.x);
  store(batch.sy + i, s.spin.y);
  store(batch.sz + i, s.spin.z);
  store(batch.slowness + i, 1.0 / s.velocity.y);
  store(batch.level + i, pack.level);
  if (aligns(region)) store(batch.prepared + i, pack.level);
  store(batch.scratch + i, pack.end);
}

}  // namespace

void turn(const Region& region, BatchView& batch, const StepRecorder* recorder) {
  batch.up = false;
  for (int i = 0; i < batch.padded; i += lane_count) {
    Pack pack = load_pack(batch, i);
    Lookout lookout{region, batch, i, words{}, words{}};
    const words particle = load(batch.particle + i);
    while (any(pack.inside)) {
      heed(call_off);
      const int zone = first_zone(pack, region.zone_count);
      const mask chosen = pack.inside & (pack.zone == code(0, zone));
      real phases[most_drives];
      for (int k = 0; k < region.zones[zone].field.drives; ++k)
        phases[k] = oscillator_phase(region.zones[zone].field.drive[k], region.key, particle);
      const StepRecorder* records = i == 0 && lane((words)chosen, 0) != 0 ? recorder : nullptr;
      lookout.level = pack.level;
      const auto visits = visit_of(region.zones[zone], region.sight_count > 0);
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
