#pragma once
// A visit to one zone of a region along a closed form, for kernels only (transport/course_lanes.hpp).
#include "transport/axis_lanes.hpp"
#include "transport/course_lanes.hpp"
#include "transport/field_lanes.hpp"
#include "transport/visit_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// How far a lane can come within a span: what its velocity swings by besides a steady bend [m/s], that bend
/// [m/s^2], and how finely things are looked at that are near [s].
struct Reach {
  real ripple, bend, finely, span;

  /// How long something `distance` away cannot be met by what now moves there with `speed` (which may be
  /// negative).
  RABILINE_LANES real time_to(real distance, real speed) const {
    const real most = speed + ripple, far = max(distance, broadcast(0));
    const real root = sqrt(fma(most, most, 2.0 * bend * far));
    const mask comes = most >= broadcast(0);
    return select(comes, 2.0 * far, root - most) / max(select(comes, most + root, bend), broadcast(0x1p-500));
  }
};

/// Along the beam at a moment of a span.
struct OnWay {
  real tau, y, speed;
};
RABILINE_LANES OnWay choose(mask m, const OnWay& a, const OnWay& b) {
  return {select(m, a.tau, b.tau), select(m, a.y, b.y), select(m, a.speed, b.speed)};
}

constexpr int most_bisections = 60;  // two or three steps of Newton's do for nearly all

/// When a lane that is on one side of a plane at `low` and on the other at `high` crosses it: Newton's
/// iteration between the two, from the cubic tau(y) through both, or where the lane has left that plane at
/// `low` and comes back to it, from a parabola, with bisections where that leads out of them. It stops behind
/// a correction below 2e-7 of the span, since the next one is of the order of its square.
template <class Curve>
RABILINE_LANES real time_of_crossing(const Curve& curve, real span, mask chosen, const OnWay& low,
                                     const OnWay& high, real plane) {
  const real one = broadcast(1), way = high.y - low.y, time = high.tau - low.tau;
  const mask rises = way > broadcast(0);
  const real u = (plane - low.y) / select(way != broadcast(0), way, one), rest = 1.0 - u;
  const auto slope = [&](real speed) { return way / select(speed != broadcast(0), speed, one); };
  const real cubic = fma(u * u * fma(broadcast(-2), u, broadcast(3)), time,
                         u * rest * (rest * slope(low.speed) - u * slope(high.speed)));
  real first = low.tau, last = high.tau;
  const mask returns = (low.y == plane) & (low.speed * way < broadcast(0));
  real tau = low.tau + select(returns, back_after(returns, low.speed, way, time), cubic);
  tau = max(first, min(last, tau));
  mask seeking = chosen;
  for (int i = 0; i < most_bisections && any(seeking); ++i) {
    const Motion m = curve.motion(tau);
    const mask before = (m.place.y < plane) == rises;
    first = select(before, tau, first);
    last = select(before, last, tau);
    const real newton = tau + (plane - m.place.y) / m.velocity.y;
    const mask inside = (newton >= first) & (newton <= last);
    const real better = select(inside, newton, 0.5 * (first + last)), step = abs(better - tau);
    tau = select(seeking, better, tau);
    seeking = seeking & ~(inside & (step <= span * 0x1p-22)) & (step > broadcast(0));
  }
  return tau;
}

/// Where the first lane is from `from` on, every `step`, before `to`.
template <class Curve>
void record_between(const StepRecorder& recorder, const Curve& curve, double from, double to, double step) {
  for (double i = 0; from + i * step < to; ++i) {
    const real tau = broadcast(from + i * step);
    record(recorder, curve.state(tau, curve.motion(tau)));
  }
}

/// Puts down what the chosen lanes are where they fly forward through planes for the first time between two
/// moments of a span. The flight itself knows nothing of it.
template <class Curve>
void look_between(const Curve& curve, Lookout& lookout, const RegionZone& zone, mask chosen,
                  const Reach& reach, real from, real to, Motion at) {
  mask looking = chosen;
  while (any(looking)) {
    const real plane = lookout.places(zone.sights_passed);
    looking = looking & (plane < broadcast(__builtin_inf()));
    // Forward flight, for as long as it is certain, meets every plane once.
    const real forward = (at.velocity.y - reach.ripple) / max(reach.bend, broadcast(0x1p-500));
    const real safe = reach.time_to(plane - at.place.y, at.velocity.y);
    looking = looking & ~(from + safe >= to);
    if (!any(looking)) return;
    const real next = min(to, from + max(max(safe, forward), reach.finely));
    const Motion there = curve.motion(next);
    OnWay begin{from, at.place.y, at.velocity.y};
    lookout.look(curve.state(from, at), there.place.y, looking, zone, [&](real y, mask crosses) {
      const real target = select(crosses, y, there.place.y);
      const OnWay end{next, there.place.y, there.velocity.y};
      const real when = time_of_crossing(curve, reach.span, crosses, begin, end, target);
      State seen = curve.state(when, curve.motion(when));
      seen.place.y = target;
      begin = choose(crosses, {when, y, seen.velocity.y}, begin);
      return seen;
    });
    looking = looking & (next < to);
    at = {select(looking, there.place, at.place), select(looking, there.velocity, at.velocity)};
    from = select(looking, next, from);
  }
}

/// Flies the chosen lanes through one zone along a curve, span by span, until each has left it, hit its wall
/// or flown too long. Within a span it goes as far as no edge and no wall can be met on the way, and where
/// one is near by `zone.step`.
template <class Curve, bool looks>
Visit visit_along(const Region& region, const RegionZone& zone, const real* phases, const State& start,
                  mask chosen, Lookout& lookout, const StepRecorder* recorder) {
  Curve curve(zone, region.take_off_spin_component, phases);
  const real begin = broadcast(zone.field.begin), end = broadcast(zone.field.end),
             span = broadcast(zone.table.span);
  const real speed = sqrt(dot(start.velocity, start.velocity));
  const real deadline = start.t + region.most_way / speed;
  const bool walled = zone.wall_radius < __builtin_inf(), in_channel = zone.channel_begin < zone.channel_end;
  const real wall = broadcast(zone.wall_radius);
  State now = start;
  mask going = chosen & in_wall(zone, far_out(region, zone, start.place));
  Visit v{now, mask{}, mask{}, chosen & ~going, mask{}};
  v.tell_wall(region, zone, v.wall, start, false);
  const auto* const call = call_off;
  while (any(going)) {
    heed(call);
    curve.begin(now);
    const Reach reach{curve.ripple() * speed, curve.bend() * speed, broadcast(zone.step), span};
    real tau = broadcast(0);
    OnWay low{tau, now.place.y, now.velocity.y}, high{span, low.y, low.speed};
    Motion at{now.place, now.velocity};
    mask on_way = going, leaves{};
    while (any(on_way)) {
      real safe = min(reach.time_to(end - at.place.y, at.velocity.y),
                      reach.time_to(at.place.y - begin, -at.velocity.y));
      if (walled || in_channel) {
        const real across = sqrt(fma(at.velocity.x, at.velocity.x, at.velocity.z * at.velocity.z));
        if (walled) safe = min(safe, reach.time_to(wall - sqrt(from_axis2(zone, at.place)), across));
        if (in_channel) safe = min(safe, reach.time_to(-far_out(region, zone, at.place).beyond, across));
      }
      const mask through = tau + safe >= span;  // nothing is met in this span any more
      const real next = select(through, span, min(span, tau + max(safe, reach.finely)));
      if (recorder != nullptr && lane((words)on_way, 0) != 0)
        record_between(*recorder, curve, lane(tau, 0), lane(next, 0), zone.step);
      if constexpr (looks) look_between(curve, lookout, zone, on_way, reach, tau, next, at);
      on_way = on_way & ~through;
      if (!any(on_way)) break;
      const Motion to = curve.motion(next);
      const real t = now.t + next;
      const FarOut farthest =
          farthest_out(region, zone, at.place, at.velocity, to.place, to.velocity, next - tau);
      const mask goes_on = (to.place.y >= begin) & in_wall(zone, farthest) & (t < deadline);
      const mask stays = goes_on & (to.place.y < end), left = on_way & ~stays;
      const mask forward = (to.place.y >= end) & left, backwards = (to.place.y < begin) & left;
      const mask hit = beyond_wall(zone, farthest) & left & ~forward & ~backwards;
      v.forward = v.forward | forward;
      v.backwards = v.backwards | backwards;
      v.wall = v.wall | hit;
      v.gave_up = v.gave_up | (left & ~forward & ~backwards & ~hit);  // or is no number any more
      leaves = leaves | left;
      low = choose(left, {tau, at.place.y, at.velocity.y}, low);
      high = choose(left, {next, to.place.y, to.velocity.y}, high);
      on_way = on_way & ~left & (next < span);
      tau = next;
      at = to;
    }
    if (any(leaves)) {
      const mask crossed = leaves & (v.forward | v.backwards);
      real when = high.tau;
      const real plane = select(v.forward, end, begin);
      if (any(crossed))
        when = select(crossed, time_of_crossing(curve, span, crossed, low, high, plane), when);
      State there = curve.state(when, curve.motion(when));
      there.place.y = select(crossed, plane, there.place.y);
      v.state = choose(leaves, there, v.state);
      if (any(leaves & (crossed | v.wall))) {
        const State from = curve.state(low.tau, curve.motion(low.tau));
        v.stop_at_wall(region, zone, crossed, from.place, from.velocity, v.state, when - low.tau);
        v.tell_wall(region, zone, v.wall & leaves, from, recorder != nullptr);
      }
      going = going & ~leaves;
    }
    if (!any(going)) break;
    now = choose(going, curve.end(span), now);
    const mask late = going & ~(now.t < deadline);
    v.state = choose(late, now, v.state);
    v.gave_up = v.gave_up | late;
    going = going & ~late;
  }
  v.state = choose(chosen, v.state, start);
  return v;
}

using VisitOfZone = Visit (*)(const Region&, const RegionZone&, const real*, const State&, mask, Lookout&,
                              const StepRecorder*);
template <bool looks>
VisitOfZone visit_on(const RegionZone& zone) {
  if (zone.course == ZoneCourse::through_field) return visit_in_field<looks>;
  if (zone.course == ZoneCourse::constant) return visit_along<ConstantTurn, looks>;
  if (zone.course == ZoneCourse::joint_turns) return visit_along<JointTurns, looks>;
  if (zone.course == ZoneCourse::slow_turns)
    return zone.field.turn_rate == zone.field.spin_rate ? visit_along<SlowTurns, looks>
                                                        : visit_along<SlowAxis, looks>;
  return visit<looks>;
}
inline VisitOfZone visit_of(const RegionZone& zone, bool looks) {
  return looks ? visit_on<true>(zone) : visit_on<false>(zone);
}

}  // namespace rabiline::RABILINE_ISA
