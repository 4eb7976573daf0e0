#pragma once
// A visit to one zone of a region, for kernels only: by steps that follow the turning
// (transport/turn_lanes.hpp).
#include "transport/plane_lanes.hpp"
#include "transport/region.hpp"
#include "transport/turn_lanes.hpp"

namespace rabiline::RABILINE_ISA {

inline void record(const StepRecorder& recorder, const State& s) {
  const double place[3] = {lane(s.place.x, 0), lane(s.place.y, 0), lane(s.place.z, 0)};
  const double velocity[3] = {lane(s.velocity.x, 0), lane(s.velocity.y, 0), lane(s.velocity.z, 0)};
  const double spin[3] = {lane(s.spin.x, 0), lane(s.spin.y, 0), lane(s.spin.z, 0)};
  recorder.record(recorder.self, lane(s.t, 0), place, velocity, spin);
}

/// The squared distance from the axis of a zone's round wall.
RABILINE_LANES real from_axis2(const RegionZone& zone, const Vector& r) {
  const real x = r.x - zone.wall_x, z = r.z - zone.wall_z;
  return fma(x, x, z * z);
}
/// How far out lanes are: that, and how far they are beyond the nearest wall of a channel [m].
struct FarOut {
  real round2, beyond;
};
/// Whether that is inside of a zone's walls, or beyond them; what is no number is neither.
RABILINE_LANES mask in_wall(const RegionZone& zone, const FarOut& out) {
  return (out.round2 <= broadcast(zone.wall_radius * zone.wall_radius)) & (out.beyond <= broadcast(0));
}
RABILINE_LANES mask beyond_wall(const RegionZone& zone, const FarOut& out) {
  return (out.round2 > broadcast(zone.wall_radius * zone.wall_radius)) | (out.beyond > broadcast(0));
}
/// Along the two axes of a channel.
RABILINE_LANES real across_channel(const RegionChannel& channel, real x, real z) {
  return fma(x, broadcast(channel.cosine), -(z * channel.sine));
}
RABILINE_LANES real up_channel(const RegionChannel& channel, real x, real z) {
  return fma(x, broadcast(channel.sine), z * channel.cosine);
}
RABILINE_LANES FarOut far_out(const Region& region, const RegionZone& zone, const Vector& r) {
  real beyond = broadcast(-1);
  for (int i = zone.channel_begin; i < zone.channel_end; ++i) {
    const RegionChannel& channel = region.channels[i];
    const real x = r.x - channel.x, z = r.z - channel.z;
    const real wall = max(abs(across_channel(channel, x, z)) - channel.half_x,
                          abs(up_channel(channel, x, z)) - channel.half_z);
    beyond = i == zone.channel_begin ? wall : max(beyond, wall);
  }
  return {from_axis2(zone, r), beyond};
}
/// The largest that something comes to which rises by `to - from` within a step, and at its end: by the cubic
/// with these slopes at both ends, in units of the step.
RABILINE_LANES real highest(real from, real to, real rises, real falls) {
  const mask turns = (rises > broadcast(0)) & (falls < broadcast(0));
  if (!any(turns)) return to;
  const real grown = to - from, cubic = rises + falls - 2.0 * grown,
             square = 3.0 * grown - 2.0 * rises - falls;
  const real root = sqrt(max(fma(square, square, -3.0 * cubic * rises), broadcast(0)));
  const real tau = rises / select(turns, root - square, broadcast(1));
  return select(turns, max(to, fma(fma(fma(cubic, tau, square), tau, rises), tau, from)), to);
}
/// How far beyond the walls of a channel at the farthest, within a step and at its end.
RABILINE_LANES real farthest_beyond(const RegionChannel& channel, const Vector& place, const Vector& velocity,
                                    const Vector& next_place, const Vector& next_velocity, real h) {
  const auto beyond = [&](auto along, double half) {
    const real begin = along(channel, place.x - channel.x, place.z - channel.z),
               end = along(channel, next_place.x - channel.x, next_place.z - channel.z),
               leaves = h * along(channel, velocity.x, velocity.z),
               arrives = h * along(channel, next_velocity.x, next_velocity.z);
    return max(highest(begin, end, leaves, arrives), highest(-begin, -end, -leaves, -arrives)) - half;
  };
  return max(beyond([](const auto&... at) { return across_channel(at...); }, channel.half_x),
             beyond([](const auto&... at) { return up_channel(at...); }, channel.half_z));
}
/// The farthest out within a step of the time h and at its end: between them a path may graze a wall. From
/// the axis of a round one by r^2, from the middle of a channel by the place itself, so that parabolas are
/// exact.
RABILINE_LANES FarOut farthest_out(const Region& region, const RegionZone& zone, const Vector& place,
                                   const Vector& velocity, const Vector& next_place,
                                   const Vector& next_velocity, real h) {
  const auto slope = [&](const Vector& r, const Vector& v) {
    return 2.0 * h * fma(r.x - zone.wall_x, v.x, (r.z - zone.wall_z) * v.z);
  };
  const real from = from_axis2(zone, place), to = from_axis2(zone, next_place),
             rises = slope(place, velocity), falls = slope(next_place, next_velocity);
  FarOut out{highest(from, to, rises, falls), broadcast(-1)};
  for (int i = zone.channel_begin; i < zone.channel_end; ++i) {
    const real wall = farthest_beyond(region.channels[i], place, velocity, next_place, next_velocity, h);
    out.beyond = i == zone.channel_begin ? wall : max(out.beyond, wall);
  }
  return out;
}

/// Which lanes touch no pole.
RABILINE_LANES mask in_gaps(const Region& region, const RegionZone& zone, const Vector& r) {
  mask free = ~mask{};
  for (int i = zone.gap_begin; i < zone.gap_end; ++i) free = free & is_in(region.gaps[i], r.x, r.z);
  return free;
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
  /// Puts down the state of what has flown forward through planes up to `now`, as `at(plane, lanes)` has it
  /// there, without meeting a wall since `from`. The flight goes on without it: looking does not change the
  /// path.
  template <class At>
  void look(const State& from, const real& now, mask flying, const RegionZone& zone, const At& at) {
    for (;;) {
      const real y = places(zone.sights_passed);
      mask crosses = flying & (now >= y);
      if (!any(crosses)) return;
      const unsigned long long plane = first_plane(crosses);
      crosses = crosses & (next == broadcast_word(plane));
      const State there = at(y, crosses);
      const FarOut farthest = farthest_out(region, zone, from.place, from.velocity, there.place,
                                           there.velocity, there.t - from.t);
      put(there, crosses & in_wall(zone, farthest) & in_gaps(region, zone, there.place), region.seen[plane]);
      next = next + select(crosses, broadcast_word(1), words{});
    }
  }

 private:
  unsigned long long first_plane(mask crosses) const {
    unsigned long long first = ~0ULL;
    for (int i = 0; i < lane_count; ++i)
      if (lane((words)crosses, i) != 0) first = std::min(first, lane(next, i));
    return first;
  }
  void put(const State& s, mask chosen, const BatchView& to) const {
    const auto keep = [&](auto* column, auto value) {
      store(column + row, select(chosen, value, load(column + row)));
    };
    keep(to.x, s.place.x);
    keep(to.z, s.place.z);
    keep(to.t, s.t);
    keep(to.vx, s.velocity.x);
    keep(to.vy, s.velocity.y);
    keep(to.vz, s.velocity.z);
    keep(to.sx, s.spin.x);
    keep(to.sy, s.spin.y);
    keep(to.sz, s.spin.z);
    keep(to.adiabaticity, load(batch.adiabaticity + row));
    keep(to.adiabaticity_y, load(batch.adiabaticity_y + row));
    keep(to.level, level);
    keep(to.prepared, level);
    keep(to.weight, load(batch.weight + row));
    keep(to.particle, load(batch.particle + row));
    keep(to.flying, ~words{});
  }
};

/// What becomes of lanes in a zone: their state at its edge or wall, and which of these they met.
struct Visit {
  State state;
  mask forward, backwards, wall, gave_up;
  mask left_map{};
  words met{};  // the number of that wall

  /// What crosses the zone's edge outside of its wall, or touched that since the last step before, met the
  /// wall.
  RABILINE_LANES void stop_at_wall(const Region& region, const RegionZone& zone, mask crossed,
                                   const Vector& place, const Vector& velocity, const State& at_edge,
                                   real since) {
    const mask meets = crossed & beyond_wall(zone, farthest_out(region, zone, place, velocity, at_edge.place,
                                                                at_edge.velocity, since));
    wall = wall | meets;
    forward = forward & ~meets;
    backwards = backwards & ~meets;
  }
  /// Whose wall the chosen lanes met since the step that began there: of several that which comes first on
  /// the cubic with the place and velocity of both ends. `traced`: their state is then that at the wall.
  void tell_wall(const Region& region, const RegionZone& zone, mask chosen, const State& from, bool traced) {
    const int round = zone.wall_radius < __builtin_inf() ? 1 : 0,
              channels = zone.channel_end - zone.channel_begin, gaps = zone.gap_end - zone.gap_begin;
    const int zone_number = static_cast<int>(&zone - region.zones),
              first_channel = region.zone_count + zone.channel_begin,
              first_gap = region.zone_count + region.channel_count + zone.gap_begin;
    const auto number = [](int n) { return broadcast_word(static_cast<unsigned long long>(n)); };
    const int only = round > 0 ? zone_number : channels > 0 ? first_channel : first_gap;
    met = select(chosen, number(only), met);
    if (!any(chosen) || (!traced && round + channels + gaps == 1)) return;
    const real h = state.t - from.t;
    const Vector begin = from.place, leaves{h * from.velocity.x, h * from.velocity.y, h * from.velocity.z};
    Vector place, slope;  // in units of the step
    const auto fly = [&](real share) {
      const auto along = [&](real p, real q, real rises, real falls, real& at, real& slope_at) {
        const real grown = q - p, cubic = rises + falls - 2.0 * grown,
                   square = 3.0 * grown - 2.0 * rises - falls;
        at = fma(fma(fma(cubic, share, square), share, rises), share, p);
        slope_at = fma(fma(3.0 * cubic, share, 2.0 * square), share, rises);
      };
      along(begin.x, state.place.x, leaves.x, h * state.velocity.x, place.x, slope.x);
      along(begin.y, state.place.y, leaves.y, h * state.velocity.y, place.y, slope.y);
      along(begin.z, state.place.z, leaves.z, h * state.velocity.z, place.z, slope.z);
    };
    const auto farthest = [&](real share) {
      return farthest_out(region, zone, begin, leaves, place, slope, share);
    };
    const real share = first_place(broadcast(0), broadcast(1), [&](real until) {
      fly(until);
      return beyond_wall(zone, farthest(until)) | ~in_gaps(region, zone, place);
    });
    fly(share);
    for (int i = zone.gap_end - 1; i >= zone.gap_begin; --i)
      met = select(chosen & ~is_in(region.gaps[i], place.x, place.z), number(first_gap + i - zone.gap_begin),
                   met);
    for (int i = zone.channel_end - 1; i >= zone.channel_begin; --i) {
      const real beyond = farthest_beyond(region.channels[i], begin, leaves, place, slope, share);
      met = select(chosen & (beyond > broadcast(0)), number(first_channel + i - zone.channel_begin), met);
    }
    const mask at_round = farthest(share).round2 > broadcast(zone.wall_radius * zone.wall_radius);
    met = select(chosen & at_round, number(zone_number), met);
    if (!traced) return;
    state.place = select(chosen, place, state.place);
    state.t = select(chosen, fma(share, h, from.t), state.t);
  }
};

/// Flies the chosen lanes through one zone, step by step, until each has left it, hit its wall or flown too
/// long. `looks`: for planes, too.
template <bool looks>
inline Visit visit(const Region& region, const RegionZone& zone, const real* phases, const State& start,
                   mask chosen, Lookout& lookout, const StepRecorder* recorder) {
  const Stepper stepper{zone.field, region.take_off_spin_component, phases};
  const real begin = broadcast(zone.field.begin), end = broadcast(zone.field.end), h = broadcast(zone.step);
  const Propagator whole_step = stepper.steps_of(h);
  const real deadline = start.t + region.most_way / sqrt(dot(start.velocity, start.velocity));
  State now = stepper.enter(start), last = now, before = now;
  mask going = chosen & in_wall(zone, far_out(region, zone, start.place));
  real ahead = looks ? min(lookout.places(zone.sights_passed), end) : end;
  Visit v{now, mask{}, mask{}, chosen & ~going, mask{}};
  v.tell_wall(region, zone, v.wall, start, false);
  const mask began = going;
  for (int steps = 1; any(going); ++steps) {
    const State old = now;
    now = stepper.step(whole_step, old);
    if (steps % steps_between_lengths == 0) {
      now.spin = of_unit_length(now.spin);
      if (stepper.in_frame()) now.frame = of_unit_length(now.frame);
    }
    const FarOut farthest = farthest_out(region, zone, old.place, old.velocity, now.place, now.velocity, h);
    const mask goes_on = (now.place.y >= begin) & in_wall(zone, farthest) & (now.t < deadline);
    if (any(going & ~(goes_on & (now.place.y < ahead)))) {
      if constexpr (looks) {
        lookout.look(old, now.place.y, going, zone, [&](real y, mask crosses) {
          return to_edge(stepper, old, h, select(crosses, y, now.place.y));  // by a shorter step, thrown away
        });
        ahead = min(lookout.places(zone.sights_passed), end);
      }
      const mask stays = goes_on & (now.place.y < end);
      const mask forward = (now.place.y >= end) & going, backwards = (now.place.y < begin) & going;
      const mask wall = beyond_wall(zone, farthest) & going & ~forward & ~backwards;
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
  if (any(crossed)) {
    v.state = choose(crossed, to_edge(stepper, before, h, select(v.forward, end, begin)), v.state);
    v.stop_at_wall(region, zone, crossed, before.place, before.velocity, v.state, v.state.t - before.t);
  }
  v.tell_wall(region, zone, v.wall & began, before, recorder != nullptr);
  v.state = choose(chosen, v.state, start);
  return v;
}

}  // namespace rabiline::RABILINE_ISA
