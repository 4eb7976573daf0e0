#pragma once
// One step where fields turn the velocity, for kernels only: dS/dt = w x S, dv/dt = W x v, dr/dt = v.
//
// Each step is of fourth order. With one rotating field the spin is exact: S is known at the two Gauss points
// of the step by constant rotations in the frame that turns with the field. Velocity: Magnus-4 from W at
// these points, so |v| is kept. Place: the integral of the turning velocity for a constant W, plus the first
// moment of W.
#include "transport/vector_lanes.hpp"

namespace rabiline::RABILINE_ISA {

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
  const real zero = broadcast(0);
  const Vector turn{broadcast(zone.drives == 1 ? zone.drive[0].turn_rate : 0), zero,
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

/// A field that turns along the beam, too: the frame turns at omega + twist v_y, and where the particle is
/// must be known to third order within the step, from the acceleration at its begin and at its first Gauss
/// point.
class TwistedStep {
 public:
  TwistedStep(const SpinZone& zone, bool take_off, real phase, const State& begin)
      : zone_(zone),
        take_off_(take_off),
        phase_(phase),
        t_(begin.t),
        way_{begin.place.y, begin.velocity.y, broadcast(0), broadcast(0)} {}

  inline State of(real h, State s) {
    const real dt1 = broadcast(gauss_first) * h, dt2 = broadcast(gauss_second) * h, zero = broadcast(0);
    const Vector a0 = cross(w_at(zero, s.spin), s.velocity);
    way_.half_a = 0.5 * a0.y;
    const Vector w1 = w_at(dt1, turned(zero, dt1, s.spin));
    const real gained = cross(w1, add(s.velocity, dt1, a0)).y - a0.y;
    way_.sixth_jerk = select(dt1 != zero, gained / select(dt1 != zero, 6.0 * dt1, broadcast(1)), zero);
    const Vector s1 = turned(zero, dt1, s.spin), s2 = turned(dt1, dt2, s1);
    move(s, w_at(dt1, s1), w_at(dt2, s2), h);
    // The frame at the end is that of the place there, which is known better than on the way.
    const real behind = zone_.drive[0].twist * (way_.at(h) - s.place.y);
    s.spin = turn_about_z(phasor(behind), turned(dt2, h, s2));
    s.t = t_ + h;
    return s;
  }

 private:
  /// In the laboratory, for a spin in the frame.
  RABILINE_LANES Vector w_at(real dt, const Vector& spin) const {
    const DriveTerm& drive = zone_.drive[0];
    const Vector turn{broadcast(drive.turn_rate), broadcast(0), broadcast(zone_.turn_rate)};
    const Phasor frame = phasor(angle_at(drive, phase_, t_ + dt, way_.at(dt)));
    return from_frame(zone_, turn_about_z(frame, turning(turn, spin, take_off_)));
  }
  RABILINE_LANES Vector rates_in_frame(real dt) const {
    const DriveTerm& drive = zone_.drive[0];
    const real speed = fma(fma(3.0 * way_.sixth_jerk, dt, 2.0 * way_.half_a), dt, way_.v);
    return {broadcast(drive.spin_rate), broadcast(0),
            fma(broadcast(-drive.twist), speed, broadcast(zone_.spin_rate - drive.omega))};
  }
  RABILINE_LANES Vector turned(real from, real to, const Vector& spin) const {
    const real h = to - from;
    return rotate(magnus(rates_in_frame(fma(broadcast(gauss_first), h, from)),
                         rates_in_frame(fma(broadcast(gauss_second), h, from)), h),
                  spin);
  }

  const SpinZone& zone_;
  bool take_off_;
  real phase_, t_;
  Way way_;
};

/// Whether fields differ along the beam within the zone.
RABILINE_LANES bool depends_on_place(const SpinZone& zone) {
  for (int i = 0; i < zone.drives; ++i)
    if (zone.drive[i].twist != 0 || zone.drive[i].envelope.shape != Shape::rectangular) return true;
  return false;
}

/// One step under any sum of rotating fields; everything in the laboratory frame.
inline State step_in_laboratory(const SpinZone& zone, bool take_off, const real* phases, real h, State s) {
  const real dt1 = broadcast(gauss_first) * h, dt2 = broadcast(gauss_second) * h, t = s.t;
  // Where fields depend on the place along the beam, it must be known to third order within the step: the
  // acceleration at its begin, and again at the first Gauss point. None here differs across the beam.
  Way way{s.place.y, s.velocity.y, broadcast(0), broadcast(0)};
  if (depends_on_place(zone)) {
    const Vector w0 = turning(rates_at(zone, phases, t, s.place).turn, s.spin, take_off),
                 a0 = cross(w0, s.velocity);
    way.half_a = 0.5 * a0.y;
    const Vector s1 = step_spin(zone, phases, t, way, broadcast(0), dt1, s.spin);
    const Vector w1 = turning(rates_at(zone, phases, t + dt1, way.place(dt1)).turn, s1, take_off);
    const real gained = cross(w1, add(s.velocity, dt1, a0)).y - a0.y;
    way.sixth_jerk = select(dt1 != broadcast(0), gained / (6.0 * dt1), broadcast(0));
  }
  const Vector s1 = step_spin(zone, phases, t, way, broadcast(0), dt1, s.spin),
               s2 = step_spin(zone, phases, t, way, dt1, dt2 - dt1, s1);
  const Vector w1 = turning(rates_at(zone, phases, t + dt1, way.place(dt1)).turn, s1, take_off);
  const Vector w2 = turning(rates_at(zone, phases, t + dt2, way.place(dt2)).turn, s2, take_off);
  move(s, w1, w2, h);
  s.spin = step_spin(zone, phases, t, way, dt2, h - dt2, s2);
  s.t = t + h;
  return s;
}

/// Rounding lengthens or shortens a spin by about the same in every step, which closure torque turns into an
/// error of the path: now and then the length is set right.
constexpr int steps_between_lengths = 16;
RABILINE_LANES Vector of_unit_length(const Vector& spin) {  // for lengths that are nearly 1
  return add(spin, 0.5 - 0.5 * dot(spin, spin), spin);
}
RABILINE_LANES Phasor of_unit_length(const Phasor& p) {
  const real more = 0.5 - 0.5 * fma(p.c, p.c, p.s * p.s);
  return {fma(p.c, more, p.c), fma(p.s, more, p.s)};
}

/// The kinds of stepping behind one face.
struct Stepper {
  const SpinZone& zone;
  bool take_off;
  const real* phases;

  bool one_rotates() const { return zone.kind == ZoneKind::precession || zone.kind == ZoneKind::rotating; }
  bool twisted() const { return zone.kind == ZoneKind::rotating && zone.drive[0].twist != 0; }
  /// The spin is given in a frame that turns with the field, at a constant rate or along the beam.
  bool in_frame() const { return one_rotates() && !zone.turned && !twisted(); }
  RABILINE_LANES Phasor frame_at(real t) const {
    return phasor(fma(broadcast(frame_rate(zone)), t, zone.drives == 1 ? phases[0] : broadcast(0)));
  }
  RABILINE_LANES Phasor twisted_frame(const State& s) const {
    return phasor(angle_at(zone.drive[0], phases[0], s.t, s.place.y));
  }
  RABILINE_LANES State enter(State s) const {
    if (twisted()) s.spin = turn_back_about_z(twisted_frame(s), to_frame(zone, s.spin));
    if (!in_frame()) return s;
    s.frame = frame_at(s.t);
    s.spin = turn_back_about_z(s.frame, s.spin);
    return s;
  }
  RABILINE_LANES State leave(State s) const {
    if (twisted()) s.spin = from_frame(zone, turn_about_z(twisted_frame(s), s.spin));
    if (in_frame()) s.spin = turn_about_z(s.frame, s.spin);
    return s;
  }
  RABILINE_LANES State step(const Propagator& p, const State& s) const {
    if (twisted()) return TwistedStep(zone, take_off, phases[0], s).of(p.h, s);
    return in_frame() ? step_in_frame(zone, take_off, p, s)
                      : step_in_laboratory(zone, take_off, phases, p.h, s);
  }
  Propagator steps_of(real h) const {
    if (in_frame()) return propagator(zone, h);
    Propagator p;
    p.h = h;
    return p;
  }
};

/// How long lanes take to come back to a plane that they leave with that speed, by the parabola on which they
/// have moved so far within h.
RABILINE_LANES real back_after(mask returns, real speed, real moved, real h) {
  const real straight = speed * h;
  return straight * h / select(returns, straight - moved, broadcast(1));
}

/// The state at the edge that a lane crosses within its next step: Newton's iteration on the length of a
/// shorter step, started from the middle, or from a parabola where the lane has just left that edge and comes
/// back to it. Six iterations leave rounding errors for steps that turn v by less than half a radian, but
/// near the top of a path.
inline State to_edge(const Stepper& stepper, const State& before, real h, real edge) {
  real length = h * 0.5;
  const real way = edge - before.place.y, speed = before.velocity.y;
  if (const mask away = way * speed <= broadcast(0); any(away)) {
    const real moved = stepper.step(stepper.steps_of(h), before).place.y - before.place.y;
    const mask returns = away & (speed * (moved - way) < broadcast(0));
    length = select(returns, back_after(returns, speed, moved, h), length);
  }
  for (int i = 0; i < 24; ++i) {
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

}  // namespace rabiline::RABILINE_ISA
