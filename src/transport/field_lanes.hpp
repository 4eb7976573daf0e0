#pragma once
// A visit to one zone of a region where fields differ from place to place, for kernels only. Each lane goes
// in steps of its own length, which it chooses by what two halves of a step differ from the whole:
//   dr/dt = v,  dS/dt = w x S,  dv/dt = W x v + a,  a = g + q E/m + the force of the gradient on the moment,
// w, W and a at the place of the lane and at its time. A step is of fourth order: they are taken at the two
// Gauss points of the path, which is known there to third order from a at the begin and at the first point.
// In an electric field w depends on the velocity too, by v x E/c^2, which is known to second order there.
#include "core/call_off.hpp"
#include "core/constants.hpp"
#include "transport/adiabaticity_lanes.hpp"
#include "transport/moment_lanes.hpp"
#include "transport/plane_lanes.hpp"
#include "transport/shaped_lanes.hpp"
#include "transport/visit_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// An angular velocity that changes evenly over a step, known at its Gauss points.
struct ChangingRate {
  Vector mean, change;
  real h;
  RABILINE_LANES ChangingRate(const Vector& first, const Vector& second, real step)
      : mean{0.5 * (first.x + second.x), 0.5 * (first.y + second.y), 0.5 * (first.z + second.z)},
        change{root_3 * (second.x - first.x), root_3 * (second.y - first.y), root_3 * (second.z - first.z)},
        h(step) {}
  /// The rotation vector from one share of the step to another (Magnus, with the first commutator): h d w +
  /// h^2 d^3/12 w' x w, d the length and w the rate in the middle.
  RABILINE_LANES Vector between(double from, double to) const {
    const double d = to - from, middle = 0.5 * (from + to) - 0.5;
    const Vector c = cross(change, mean);
    const real length = h * d, commutator = h * h * (d * d * d / 12);
    return add(
        {length * fma(change.x, broadcast(middle), mean.x), length * fma(change.y, broadcast(middle), mean.y),
         length * fma(change.z, broadcast(middle), mean.z)},
        commutator, c);
  }
  static constexpr double root_3 = 1.7320508075688772935;
};

/// What acts at one place and time.
struct Influence {
  Vector spin, turn;  // [rad/s] w, and W before its part along S is taken off
  Vector slope[3];    // [m/s^2] what S along x, y, z accelerates by
  Vector push;        // [m/s^2] what a level does, or E
};

/// What two halves and a whole step of fourth order would come to with ever shorter steps.
RABILINE_LANES State extrapolated(const State& whole, State halves) {
  const auto on = [](const Vector& a, const Vector& b) {
    return Vector{fma(b.x - a.x, broadcast(1.0 / 15), b.x), fma(b.y - a.y, broadcast(1.0 / 15), b.y),
                  fma(b.z - a.z, broadcast(1.0 / 15), b.z)};
  };
  halves.place = on(whole.place, halves.place);
  halves.velocity = on(whole.velocity, halves.velocity);
  halves.spin = on(whole.spin, halves.spin);
  return halves;
}

struct FieldStepper {
  const Region& region;
  const RegionZone& zone;
  const real* phases;
  real part;  // of the whole moment that pulls: (m/I) under `quantum`, else 1
  words level;

  bool turns() const {
    return region.feels.turn_per_tesla != 0 || zone.field.turn_rate != 0 ||
           (zone.field.drives > 0 && zone.field.drive[0].turn_rate != 0) ||
           (is_electric() && region.feels.electric.turn_share != 0);
  }
  bool is_electric() const { return zone.shaped_end < zone.electric_end; }
  bool bends() const { return turns() || region.feels.pull != 0; }
  RABILINE_LANES Vector gravity() const {
    const double* g = region.feels.gravity;
    return {broadcast(g[0]), broadcast(g[1]), broadcast(g[2])};
  }

  /// `velocity()` is asked only where it matters.
  template <class Velocity>
  inline Influence at(real t, const Vector& r, const Velocity& velocity) const {
    const Rates uniform = rates_at(zone.field, phases, t, r);
    Influence here{uniform.spin, uniform.turn, {}, {}};
    if (is_electric()) add_electric(r, velocity(), here);
    if (zone.shaped_begin == zone.shaped_end) return here;
    FieldHere<real> field{};
    for (int i = zone.shaped_begin; i < zone.shaped_end; ++i)
      add_field_at(region.shaped[i], zone.field, phases, t, r, field);
    const Vector b{field.field[0], field.field[1], field.field[2]};
    here.spin = add(here.spin, broadcast(region.feels.spin_per_tesla), b);
    here.turn = add(here.turn, broadcast(region.feels.turn_per_tesla), b);
    if (region.feels.pull == 0) return here;
    if (region.feels.follows_level) {
      along_field(field, here);
      return here;
    }
    const real pull = part * region.feels.pull;
    for (int i = 0; i < 3; ++i)
      here.slope[i] = {pull * field.slope[3 * i], pull * field.slope[3 * i + 1],
                       pull * field.slope[3 * i + 2]};
    return here;
  }
  inline void add_electric(const Vector& r, const Vector& v, Influence& here) const {
    const ElectricCoupling& feels = region.feels.electric;
    FieldHere<real> field{};
    for (int i = zone.shaped_end; i < zone.electric_end; ++i)
      add_field<LaneMaths>(region.shaped[i], r.x, r.y, r.z, field);
    const Vector e{field.field[0], field.field[1], field.field[2]};
    constexpr double per_c2 = 1 / (constants::speed_of_light * constants::speed_of_light);
    const Vector turn = add(
        Vector{feels.spin_per_electric * e.x, feels.spin_per_electric * e.y, feels.spin_per_electric * e.z},
        broadcast(-per_c2 * feels.spin_per_motional), cross(v, e));
    here.spin = add(here.spin, broadcast(1), turn);
    here.turn = add(here.turn, broadcast(feels.turn_share), turn);
    here.push = {feels.acceleration * e.x, feels.acceleration * e.y, feels.acceleration * e.z};
  }
  /// mu grad |B| = mu (B . dB/dx_k)/|B|, zero where B is 0 and has no direction.
  /// No spin is carried.
  inline void along_field(const FieldHere<real>& field, Influence& here) const {
    const real b[3] = {field.field[0] + zone.uniform[0], field.field[1] + zone.uniform[1],
                       field.field[2] + zone.uniform[2]},
               size2 = fma(b[0], b[0], fma(b[1], b[1], b[2] * b[2]));
    const real size = sqrt(size2), over = select(size > broadcast(0), 1.0 / size, broadcast(0));
    const MomentLaw& moments = region.feels.moments;
    const real pull = moments.coefficients == nullptr
                          ? part * region.feels.pull
                          : moment_of(moments, level, size) * (1 / region.feels.mass);
    const auto grows = [&](int k) {
      const real* g = field.slope + k;
      return fma(b[0], g[0], fma(b[1], g[3], b[2] * g[6])) * over * pull;
    };
    here.spin = here.turn = Vector{};
    here.push = {grows(0), grows(1), grows(2)};
  }
  /// F = grad (mu . B), mu along S, or that of a level.
  RABILINE_LANES Vector pull_at(const Influence& here, const Vector& spin) const {
    Vector g = gravity();
    if (region.feels.follows_level || is_electric()) g = add(g, broadcast(1), here.push);
    return region.feels.follows_level || region.feels.pull == 0
               ? g
               : add(add(add(g, spin.x, here.slope[0]), spin.y, here.slope[1]), spin.z, here.slope[2]);
  }
  RABILINE_LANES Vector acceleration(const Influence& here, const Vector& spin,
                                     const Vector& velocity) const {
    return add(cross(turning(here.turn, spin, region.take_off_spin_component), velocity), broadcast(1),
               pull_at(here, spin));
  }
  RABILINE_LANES static Vector place_after(const State& s, real dt, const Vector& a, const Vector& jerk) {
    const auto along = [&](real r, real v, real a0, real j) {
      return fma(fma(fma(j * (1.0 / 6), dt, 0.5 * a0), dt, v), dt, r);
    };
    return {along(s.place.x, s.velocity.x, a.x, jerk.x), along(s.place.y, s.velocity.y, a.y, jerk.y),
            along(s.place.z, s.velocity.z, a.z, jerk.z)};
  }

  RABILINE_LANES static Vector velocity_after(const State& s, real dt, const Vector& a, const Vector& jerk) {
    const auto along = [&](real v, real a0, real j) { return fma(fma(0.5 * j, dt, a0), dt, v); };
    return {along(s.velocity.x, a.x, jerk.x), along(s.velocity.y, a.y, jerk.y),
            along(s.velocity.z, a.z, jerk.z)};
  }

  /// What acts where a step begins, as far as that bends its path.
  inline Influence begin(const State& s) const {
    return bends() ? at(s.t, s.place, [&] { return s.velocity; }) : Influence{};
  }
  /// One step of the length h from there, and the square of the angle by which it turns the spin.
  inline State once(real h, State s, const Influence& first, real* angle2 = nullptr) const {
    const real dt1 = gauss_first * h, dt2 = gauss_second * h;
    Vector a0 = gravity(), jerk{};
    if (bends()) {
      a0 = acceleration(first, s.spin, s.velocity);
      const Vector turned = turned_by({dt1 * first.spin.x, dt1 * first.spin.y, dt1 * first.spin.z}, s.spin);
      const auto velocity1 = [&] { return add(s.velocity, dt1, a0); };
      const Vector a1 =
          acceleration(at(s.t + dt1, place_after(s, dt1, a0, Vector{}), velocity1), turned, velocity1());
      const real over = 1.0 / select(dt1 != broadcast(0), dt1, broadcast(1));
      jerk = {(a1.x - a0.x) * over, (a1.y - a0.y) * over, (a1.z - a0.z) * over};
    }
    const auto known_at = [&](real dt) {
      return at(s.t + dt, place_after(s, dt, a0, jerk), [&] { return velocity_after(s, dt, a0, jerk); });
    };
    const Influence at1 = known_at(dt1), at2 = known_at(dt2);
    const ChangingRate spin(at1.spin, at2.spin, h);
    const Vector s0 = s.spin, velocity = s.velocity;
    const Vector rotation = spin.between(0, 1);
    s.spin = turned_by(rotation, s0);
    if (angle2 != nullptr) *angle2 = dot(rotation, rotation);
    s.t = s.t + h;
    const Vector s1 = turned_by(spin.between(0, gauss_first), s0),
                 s2 = turned_by(spin.between(0, gauss_second), s0);
    const Vector pull1 = pull_at(at1, s1), pull2 = pull_at(at2, s2);
    const real half = 0.5 * h, late1 = half * h * (1 - gauss_first), late2 = half * h * (1 - gauss_second);
    if (!turns()) {
      s.place = add(add(add(s.place, h, velocity), late1, pull1), late2, pull2);
      s.velocity = add(add(velocity, half, pull1), half, pull2);
      return s;
    }
    const Vector w1 = turning(at1.turn, s1, region.take_off_spin_component),
                 w2 = turning(at2.turn, s2, region.take_off_spin_component);
    move(s, w1, w2, h);
    const ChangingRate turn(w1, w2, h);
    const Vector o1 = turn.between(gauss_first, 1), o2 = turn.between(gauss_second, 1);
    s.place = add(add(s.place, late1, mean_of_turning(o1, pull1)), late2, mean_of_turning(o2, pull2));
    s.velocity = add(add(s.velocity, half, rotate(o1, pull1)), half, rotate(o2, pull2));
    return s;
  }
  /// Of two halves, without the error that the whole step tells.
  inline State better(real h, const State& s, const Influence& first) const {
    return extrapolated(once(h, s, first), twice(h, s, first));
  }
  inline State twice(real h, const State& s, const Influence& first) const {
    const State middle = once(0.5 * h, s, first);
    return once(0.5 * h, middle, begin(middle));
  }

  /// Which lanes are outside of a map that nothing may leave.
  inline mask outside_maps(const Vector& r) const {
    mask outside{};
    for (int i = zone.shaped_begin; i < zone.electric_end; ++i)
      outside = outside | (is_lost<LaneMaths>(region.shaped[i], r.x, r.y, r.z) > broadcast(0));
    return outside;
  }

  /// No longer than a radian of the velocity's turning.
  inline real longest(const Influence& first, real most) const {
    if (!turns()) return most;
    return min(most, 1.0 / max(sqrt(dot(first.turn, first.turn)), broadcast(0x1p-500)));
  }

  /// Nor beyond a moment at which a drive is switched, or the course of a field bends: a step would not see
  /// it between its Gauss points. One that rounding leaves just ahead is passed over.
  inline real until_change(const State& s, real most) const {
    const real latest = s.t + most, from = fma(abs(s.t), broadcast(1e-14), s.t);
    real next = latest;
    for (int k = 0; k < zone.field.drives; ++k) next = next_change(zone.field.drive[k], from, next);
    for (int i = zone.shaped_begin; i < zone.shaped_end; ++i)
      if (const TimeCourse& course = region.shaped[i].course; course.nodes > 0)
        next = next_stop<LaneMaths>(course, from, next);
    return select(next < latest, next - s.t, most);
  }

  bool follows_courses() const {
    for (int i = zone.shaped_begin; i < zone.shaped_end; ++i)
      if (region.shaped[i].course.nodes > 0) return true;
    return false;
  }

  /// Nor beyond a surface where a field jumps. What bends away from it may also be bent towards it: surfaces
  /// are looked for twice as far ahead, and the bend allowed for is twice what is found here or straight
  /// ahead.
  inline real until_face(const State& s, real most) const {
    const real place[3] = {s.place.x, s.place.y, s.place.z},
               velocity[3] = {s.velocity.x, s.velocity.y, s.velocity.z}, soonest = abs(s.t) * 1e-14;
    const auto next_face = [&](const real& bend, real face) {
      for (int i = zone.shaped_begin; i < zone.electric_end; ++i)
        face = time_to_face<LaneMaths>(region.shaped[i], place, velocity, bend, soonest, face);
      return face;
    };
    const real far = 2.0 * most;
    if (!any(next_face(broadcast(0), far) < far)) return most;
    const auto acceleration_after = [&](const real& dt) {
      const auto velocity_here = [&] { return s.velocity; };
      return acceleration(at(s.t + dt, add(s.place, dt, s.velocity), velocity_here), s.spin, s.velocity);
    };
    const Vector here = acceleration_after(broadcast(0)), ahead = acceleration_after(most);
    return next_face(2.0 * sqrt(max(dot(here, here), dot(ahead, ahead))), most);
  }

  /// The state where a lane first comes to `plane` within its next step of the length h, or comes back to it.
  inline State at_plane(const State& before, real h, real plane) const {
    const real way = plane - before.place.y, speed = before.velocity.y;
    real length = max(broadcast(0), min(h, way / speed));
    const Influence first = begin(before);
    if (const mask away = way * speed <= broadcast(0); any(away)) {
      const real moved = better(h, before, first).place.y - before.place.y;
      const mask returns = away & (speed * (moved - way) < broadcast(0));
      length = select(returns, back_after(returns, speed, moved, h), length);
    }
    mask settled{};                                  // stays as it is, whatever the other lanes still need
    for (int i = 0; i < 24 && !all(settled); ++i) {  // each halves it at least, near the top of a path
      const State there = better(length, before, first);
      const real newton = max(broadcast(0), min(h, length + (plane - there.place.y) / there.velocity.y));
      const real next = select((there.velocity.y != broadcast(0)) & ~settled, newton, length);
      settled = settled | (abs(next - length) <= 1e-13 * h);
      length = next;
    }
    State there = better(length, before, first);
    there.place.y = plane;
    return there;
  }
};

/// By how much two states of a step differ, over what is allowed of direction, spin and place.
RABILINE_LANES real difference(const State& a, const State& b, double length) {
  const auto size2 = [](const Vector& u, const Vector& v) {
    const Vector d{u.x - v.x, u.y - v.y, u.z - v.z};
    return dot(d, d);
  };
  const real speed2 = dot(b.velocity, b.velocity);
  return sqrt(max(max(size2(a.spin, b.spin), size2(a.velocity, b.velocity) / speed2),
                  size2(a.place, b.place) * (1 / (length * length))));
}

/// Flies the chosen lanes through one zone until each has left it, hit its wall or flown too long.
template <bool looks>
inline Visit visit_in_field(const Region& region, const RegionZone& zone, const real* phases,
                            const State& start, mask chosen, Lookout& lookout, const StepRecorder* recorder) {
  const real part = region.feels.levels > 0 ? fma(number_of(lookout.level),
                                                  broadcast(-2.0 / (region.feels.levels - 1)), broadcast(1))
                                            : broadcast(1);
  const FieldStepper stepper{region, zone, phases, part, lookout.level};
  const double length = zone.field.end - zone.field.begin;
  const real begin = broadcast(zone.field.begin), end = broadcast(zone.field.end);
  const real speed = sqrt(dot(start.velocity, start.velocity)), stay = length / speed;
  const real deadline = start.t + region.most_way / speed, most = zone.longest / speed;
  State now = start, before = start;
  real h = most, last_h = h, steps = broadcast(0);
  mask going =
      chosen & in_wall(zone, far_out(region, zone, start.place)) & in_gaps(region, zone, start.place);
  const bool switched = is_switched(zone.field) || stepper.follows_courses();
  Visit v{now, mask{}, mask{}, chosen & ~going, mask{}};
  v.tell_wall(region, zone, v.wall, start, false);
  const mask began = going;
  const auto* const call = call_off;
  while (any(going)) {
    heed(call);
    // Straight ahead a step ends on the zone's end: only bent paths go beyond it.
    const real ahead = (end - now.place.y) / now.velocity.y;
    const mask comes = now.velocity.y > broadcast(0);
    const Influence first = stepper.begin(now);
    const real free = stepper.longest(first, min(h, most)), to_end = select(comes, min(free, ahead), free);
    const real trial = stepper.until_face(now, switched ? stepper.until_change(now, to_end) : to_end);
    real angle2 = broadcast(0);
    const State whole = stepper.once(trial, now, first, &angle2), halves = stepper.twice(trial, now, first);
    // Each half has a 32nd of the whole step's error, both of them a 16th: what they differ by, over 15, is
    // taken off (Richardson), so that what is left is of fifth order and smaller than what steps are chosen
    // by. That is so while a step turns the spin by a radian or two; halves of one that turns it further may
    // be off by as much as the whole, so that the share rises to 1, which it comes to at 8 rad. A jump of
    // the field may take a thousandth of the tolerance, or steps would become shorter for ever.
    const real share = min(broadcast(1), max(broadcast(1), 0.25 * angle2) * (1.0 / 15)),
               allowed = region.feels.tolerance * (0.1 * (trial / stay) + 1e-3),
               error = difference(whole, halves, length) * share / allowed;
    const mask rejected = error > broadcast(1), steps_on = going & ~rejected;
    const real root = sqrt(sqrt(max(error, broadcast(1e-4))));
    h = select(steps_on & (trial < 0.5 * free), free, max(0.2 * trial, min(4.0 * trial, 0.9 * trial / root)));
    const State old = now;
    now = choose(steps_on, extrapolated(whole, halves), now);
    now.spin = of_unit_length(now.spin);
    steps = steps + 1.0;
    if (region.feels.watches_turning)
      Adiabaticity(region, zone, lookout.batch, lookout.row).watch(old, now, steps_on);
    if constexpr (looks)
      lookout.look(old, now.place.y, steps_on, zone, [&](real y, mask crosses) {
        return stepper.at_plane(old, trial, select(crosses, y, now.place.y));
      });
    const FarOut farthest =
        farthest_out(region, zone, old.place, old.velocity, now.place, now.velocity, trial);
    const mask in_gap = in_gaps(region, zone, now.place);
    const mask inside = (now.place.y >= begin) & in_wall(zone, farthest) & in_gap;
    const mask in_time = (now.t < deadline) & (steps < broadcast(most_field_steps));
    const mask arrives = (now.place.y >= end - 1e-14 * (abs(end) + length)) & in_gap;
    const mask lost = stepper.outside_maps(now.place) & steps_on & ~arrives;
    const mask stays = inside & in_time & ~arrives & ~lost;
    const mask leaves = (steps_on & ~stays) | (going & ~in_time);
    const mask forward = arrives & steps_on, backwards = (now.place.y < begin) & steps_on;
    const mask wall = (beyond_wall(zone, farthest) | ~in_gap) & steps_on & ~forward & ~backwards;
    before = choose(leaves, old, before);
    last_h = select(leaves, trial, last_h);
    v.state = choose(leaves, now, v.state);
    v.forward = v.forward | forward;
    v.backwards = v.backwards | backwards;
    v.wall = v.wall | wall;
    v.left_map = v.left_map | (lost & ~backwards & ~wall);
    v.gave_up = v.gave_up | (leaves & ~forward & ~backwards & ~wall & ~lost);  // or is no number any more
    going = going & ~leaves;
    if (recorder != nullptr && lane((words)(going & steps_on), 0) != 0) record(*recorder, now);
  }
  const mask beyond = (v.forward & (v.state.place.y > end + 1e-14 * (abs(end) + length))) | v.backwards;
  if (any(beyond))
    v.state = choose(beyond, stepper.at_plane(before, last_h, select(v.forward, end, begin)), v.state);
  v.state.place.y = select(v.forward, end, select(v.backwards, begin, v.state.place.y));
  v.stop_at_wall(region, zone, v.forward | v.backwards, before.place, before.velocity, v.state,
                 v.state.t - before.t);
  v.tell_wall(region, zone, v.wall & began, before, recorder != nullptr);
  v.state = choose(chosen, v.state, start);
  return v;
}

}  // namespace rabiline::RABILINE_ISA
