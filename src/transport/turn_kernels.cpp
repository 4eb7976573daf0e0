// Fields that turn the velocity: dS/dt = w x S, dv/dt = W x v, dr/dt = v, in a region of touching zones that
// a particle may cross in either direction.
//
// Each step is of fourth order. With one rotating field the spin is exact: S is known at the two Gauss points
// of the step by constant rotations in the frame that turns with the field. Velocity: Magnus-4 from W at
// these points, so |v| is kept. Place: the integral of the turning velocity for a constant W, plus the first
// moment of W.
#include "transport/kernel_functions.hpp"
#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

struct State {
  real t;
  Vector place, velocity, spin;
  Phasor frame;  // angle of the frame that `spin` is given in, where a zone uses one
};

RABILINE_LANES State choose(mask m, const State& a, const State& b) {
  return {select(m, a.t, b.t),
          select(m, a.place, b.place),
          select(m, a.velocity, b.velocity),
          select(m, a.spin, b.spin),
          {select(m, a.frame.c, b.frame.c), select(m, a.frame.s, b.frame.s)}};
}

/// What one step of length h does to spin and phase in a zone with one rotating field (or none, then the
/// frame turns with the precession): from the step's begin to the first Gauss point, to the second, to its
/// end.
struct Propagator {
  real h;
  Matrix spin[3];
  Phasor phase[3];
};

/// The frame's rate: the field's, or the precession's where nothing rotates.
RABILINE_LANES double frame_rate(const SpinZone& zone) {
  return zone.drives == 1 ? zone.drive[0].omega : zone.spin_rate;
}

RABILINE_LANES Propagator propagator(const SpinZone& zone, real h) {
  const double w1 = zone.drives == 1 ? zone.drive[0].spin_rate : 0,
               detuned = zone.spin_rate - frame_rate(zone);
  const double rate = __builtin_sqrt(detuned * detuned + w1 * w1);
  const double ux = rate > 0 ? w1 / rate : 0, uz = rate > 0 ? detuned / rate : 1;
  const double part[3] = {gauss_first, gauss_second - gauss_first, 1 - gauss_second};
  Propagator p;
  p.h = h;
  for (int k = 0; k < 3; ++k) {
    p.spin[k] = rotation_in_xz_axis(ux, uz, h * (part[k] * rate));
    p.phase[k] = phasor(h * (part[k] * frame_rate(zone)));
  }
  return p;
}

/// The velocity's angular velocity: the field's turning, without its part along S under closure `torque`.
RABILINE_LANES Vector turning(const Vector& turn, const Vector& spin, bool take_off) {
  return take_off ? add(turn, -dot(turn, spin), spin) : turn;
}

/// Velocity and place over a step from W at its two Gauss points.
RABILINE_LANES void move(State& s, const Vector& w1, const Vector& w2, real h) {
  const Vector o = magnus(w1, w2, h);
  const real q = dot(o, o);
  real sine, cosine;
  rotation_coefficients(q, sine, cosine);
  // -(a - sin a)/a^3 for a^2 = q <= 1, by its series
  const real minus_integral = polynomial(q, {-1.0 / 1307674368000, 1.0 / 6227020800, -1.0 / 39916800,
                                             1.0 / 362880, -1.0 / 5040, 1.0 / 120, -1.0 / 6});
  const Vector u = cross(o, s.velocity), uu = cross(o, u);
  // r += h [v + C o x v + I o x (o x v)], C = (1 - cos a)/a^2, I = (a - sin a)/a^3: exact for a constant W.
  s.place = add(s.place, h, add(add(s.velocity, cosine, u), -minus_integral, uu));
  // The first moment of W, h^2 sqrt(3)/12 (W1 - W2) x v at half the step.
  const Vector moment = cross({w1.x - w2.x, w1.y - w2.y, w1.z - w2.z}, add(s.velocity, broadcast(0.5), u));
  s.place = add(s.place, h * h * magnus_commutator, moment);
  s.velocity = add(add(s.velocity, sine, u), cosine, uu);
}

/// One step where at most one field rotates; the spin is given in the field's frame.
RABILINE_LANES State step_in_frame(const SpinZone& zone, bool take_off, const Propagator& p, State s) {
  const Vector turn{broadcast(zone.drives == 1 ? zone.drive[0].turn_rate : 0), real{},
                    broadcast(zone.turn_rate)};
  const Vector s1 = p.spin[0] * s.spin, s2 = p.spin[1] * s1;
  const Phasor e1 = s.frame * p.phase[0], e2 = e1 * p.phase[1];
  const Vector w1 = turn_about_z(e1, turning(turn, s1, take_off)),
               w2 = turn_about_z(e2, turning(turn, s2, take_off));
  move(s, w1, w2, p.h);
  s.spin = p.spin[2] * s2;
  s.frame = e2 * p.phase[2];
  s.t = s.t + p.h;
  return s;
}

/// One step under any sum of rotating fields; everything in the laboratory frame.
State step_in_laboratory(const SpinZone& zone, bool take_off, const real* phases, real h, State s) {
  const real dt1 = broadcast(gauss_first) * h, dt2 = broadcast(gauss_second) * h, t = s.t;
  // Where fields depend on the place, it must be known to second order within the step.
  const Vector w0 = turning(rates_at(zone, phases, t, s.place.y).turn, s.spin, take_off);
  const Way way{s.place.y, s.velocity.y, 0.5 * cross(w0, s.velocity).y};
  const Vector s1 = step_spin(zone, phases, t, way, broadcast(0), dt1, s.spin),
               s2 = step_spin(zone, phases, t, way, dt1, dt2 - dt1, s1);
  const Vector w1 = turning(rates_at(zone, phases, t + dt1, way.at(dt1)).turn, s1, take_off);
  const Vector w2 = turning(rates_at(zone, phases, t + dt2, way.at(dt2)).turn, s2, take_off);
  move(s, w1, w2, h);
  s.spin = step_spin(zone, phases, t, way, dt2, h - dt2, s2);
  s.t = t + h;
  return s;
}

/// The two kinds of stepping behind one face; the spin is kept at length 1, or rounding would add up.
struct Stepper {
  const SpinZone& zone;
  bool take_off;
  const real* phases;

  bool in_frame() const {
    return !zone.turned && (zone.kind == ZoneKind::precession ||
                            (zone.kind == ZoneKind::rotating && zone.drive[0].twist == 0));
  }
  RABILINE_LANES Phasor frame_at(real t) const {
    return phasor(fma(broadcast(frame_rate(zone)), t, zone.drives == 1 ? phases[0] : broadcast(0)));
  }
  RABILINE_LANES State enter(State s) const {
    if (!in_frame()) return s;
    s.frame = frame_at(s.t);
    s.spin = turn_back_about_z(s.frame, s.spin);
    return s;
  }
  RABILINE_LANES State leave(State s) const {
    if (in_frame()) s.spin = turn_about_z(s.frame, s.spin);
    return s;
  }
  RABILINE_LANES State step(const Propagator& p, const State& s) const {
    State next =
        in_frame() ? step_in_frame(zone, take_off, p, s) : step_in_laboratory(zone, take_off, phases, p.h, s);
    next.spin = add(next.spin, 0.5 - 0.5 * dot(next.spin, next.spin), next.spin);
    return next;
  }
  Propagator steps_of(real h) const {
    if (in_frame()) return propagator(zone, h);
    Propagator p;
    p.h = h;
    return p;
  }
};

/// The state at the edge that a lane crosses within its next step: Newton's iteration on the length of a
/// shorter step, started from the straight line. Six iterations leave rounding errors for steps that turn v
/// by less than half a radian.
State to_edge(const Stepper& stepper, const State& before, real h, real edge) {
  real length = h * 0.5;
  for (int i = 0; i < 6; ++i) {
    const State at = stepper.step(stepper.steps_of(length), before);
    const real newton = max(broadcast(0), min(h, length + (edge - at.place.y) / at.velocity.y));
    const real better = select(at.velocity.y != broadcast(0), newton, length);
    if (all(better == length)) break;
    length = better;
  }
  State at = stepper.step(stepper.steps_of(length), before);
  at.place.y = edge;
  return stepper.leave(at);
}

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
  while (any(going)) {
    const State old = now;
    now = stepper.step(whole_step, old);
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
