#pragma once
// Spins through the fields of a straight flight, for kernels only.
#include "transport/vector_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// The spin after a zone that it enters at time t and leaves after `stay`, turned exactly: in the frame that
/// turns with the field at omega, the spin turns about (w1, 0, w0 - omega).
inline Vector through_rotating(const SpinZone& zone, real phase, real t, real stay, const Vector& s) {
  const DriveTerm& drive = zone.drive[0];
  const double detuned = zone.spin_rate - drive.omega;
  const double rate = __builtin_sqrt(detuned * detuned + drive.spin_rate * drive.spin_rate);
  const Phasor in = phasor(fma(broadcast(drive.omega), t, phase));
  Vector r = turn_back_about_z(in, s);
  if (rate > 0) r = rotation_in_xz_axis(drive.spin_rate / rate, detuned / rate, stay * rate) * r;
  return turn_about_z(phasor(stay * drive.omega), turn_about_z(in, r));
}

/// v turned right-handed about the unit vector u by an angle.
inline Vector turned_about(const Vector& u, real angle, const Vector& v) {
  real s, c, half_s, half_c;
  sincos(angle, s, c);
  sincos(angle * 0.5, half_s, half_c);
  const Vector across = cross(u, v);
  return add(add(v, s, across), 2.0 * half_s * half_s, cross(u, across));
}

/// The same where the field's direction also turns along the beam: each speed sees its own frequency.
inline Vector through_twisted(const SpinZone& zone, real phase, real t, real stay, real slowness,
                              const Vector& s) {
  const DriveTerm& drive = zone.drive[0];
  const real omega = broadcast(drive.omega) + drive.twist / slowness;
  const real w1 = broadcast(drive.spin_rate), detuned = zone.spin_rate - omega;
  const real rate = max(sqrt(fma(detuned, detuned, w1 * w1)), broadcast(0x1p-500));
  const Phasor in = phasor(angle_at(drive, phase, t, broadcast(zone.begin)));
  const Vector axis{w1 / rate, broadcast(0), detuned / rate};
  const Vector r = turned_about(axis, stay * rate, turn_back_about_z(in, s));
  return turn_about_z(phasor(stay * omega), turn_about_z(in, r));
}

/// Calls step(from, spin), step = steps_of(h), for as many equal steps as a piece of each particle's stay
/// asks for.
template <class StepsOf>
RABILINE_LANES Vector in_even_steps(const SpinZone& zone, real begin, real length, Vector s,
                                    const StepsOf& steps_of) {
  const real steps = max(broadcast(1), -floor(length * (-1 / zone.step)));
  const real h = length / steps;
  auto step = steps_of(h);
  for (real i = broadcast(0); any(i < steps); i = i + 1.0)
    s = select(i < steps, step(fma(h, i, begin), s), s);
  return s;
}

/// Steps through a whole zone that is entered at time t; they end where a drive is switched or a sweep begins
/// or ends.
template <class StepsOf>
RABILINE_LANES Vector in_steps(const SpinZone& zone, real t, real stay, Vector s, const StepsOf& steps_of) {
  if (!is_switched(zone)) return in_even_steps(zone, broadcast(0), stay, s, steps_of);
  const real end = t + stay;
  for (real now = t; any(now < end);) {
    real next = end;
    for (int k = 0; k < zone.drives; ++k) next = next_change(zone.drive[k], now, next);
    s = select(now < end, in_even_steps(zone, now - t, max(broadcast(0), next - now), s, steps_of), s);
    now = max(now, next);
  }
  return s;
}

/// Half a sine at the Gauss points of equal steps from the begin of a way on, each from the one before.
class HalfSineSteps {
 public:
  HalfSineSteps(const Envelope& envelope, const Way& way, real h) {
    const double per_metre = 3.141592653589793 / envelope.length;
    const real turn = per_metre * way.v * h;
    first_ = phasor(fma(broadcast(gauss_first), turn, per_metre * (way.y - envelope.begin)));
    inside_ = phasor((gauss_second - gauss_first) * turn);
    whole_ = phasor(turn);
  }
  RABILINE_LANES real first() const { return first_.s; }
  RABILINE_LANES real second() const { return (first_ * inside_).s; }
  RABILINE_LANES void go_on() { first_ = first_ * whole_; }

 private:
  Phasor first_, inside_, whole_;
};
RABILINE_LANES bool is_half_sine(const SpinZone& zone) {
  const Slopes& slopes = zone.drive[0].slopes;
  return zone.drive[0].envelope.shape == Shape::half_sine && !is_switched(zone) && slopes.size_x == 0 &&
         slopes.size_z == 0;
}

/// A field whose size or rate changes on the way: fourth-order steps in the frame that turns with it.
inline Vector through_profiled(const SpinZone& zone, real phase, real t, real stay, const Way& way,
                               const Vector& s) {
  const DriveTerm& drive = zone.drive[0];
  real omega = broadcast(drive.omega) + drive.twist * way.v;
  if (drive.slopes.phase_x != 0 || drive.slopes.phase_z != 0)
    omega = omega + fma(broadcast(drive.slopes.phase_x), way.vx, drive.slopes.phase_z * way.vz);
  const real detuned = zone.spin_rate - omega, zero = broadcast(0);
  const bool sweeps = drive.sweep.rate != 0;
  // Of a fall across the beam, along which its phase differs.
  const double chirp = drive.slopes.phase_x * way.ax + drive.slopes.phase_z * way.az;  // [rad/s^2]
  const Phasor in = phasor(angle_at(drive, phase, t, way.place(zero)));
  const auto rates = [&](real dt) {
    const real fallen = fma(broadcast(-chirp), dt, detuned);
    const real off = sweeps ? fallen - swept_rate(drive.sweep, t + dt) : fallen;
    return Vector{drive.spin_rate * share_of(drive, t + dt, way.place(dt)), zero, off};
  };
  const Vector start = turn_back_about_z(in, s);
  const Vector r = is_half_sine(zone) && chirp == 0
                       ? in_even_steps(zone, zero, stay, start,
                                       [&](real h) {
                                         return [&, h, sine = HalfSineSteps(drive.envelope, way, h)](
                                                    real, const Vector& now) mutable {
                                           const Vector w1{drive.spin_rate * sine.first(), zero, detuned},
                                               w2{drive.spin_rate * sine.second(), zero, detuned};
                                           sine.go_on();
                                           return rotate(magnus(w1, w2, h), now);
                                         };
                                       })
                       : in_steps(zone, t, stay, start, [&](real h) {
                           return [&, h](real from, const Vector& now) {
                             return rotate(magnus(rates(fma(broadcast(gauss_first), h, from)),
                                                  rates(fma(broadcast(gauss_second), h, from)), h),
                                           now);
                           };
                         });
  real turn = stay * fma(broadcast(0.5 * chirp), stay, omega);
  if (sweeps) turn = turn + (swept_angle(drive.sweep, t + stay) - swept_angle(drive.sweep, t));
  return turn_about_z(phasor(turn), turn_about_z(in, r));
}

/// v turned by a unit quaternion, or turned back.
RABILINE_LANES Vector turned_by_quaternion(const real (&q)[4], bool back, const Vector& v) {
  const Vector u{q[1], q[2], q[3]};
  const Vector across = cross(u, v);
  const real w = (back ? -2.0 : 2.0) * q[0];
  return add(add(v, w, across), broadcast(2), cross(u, across));
}
/// P at an angle of the clock.
RABILINE_LANES void periodic_part(const FloquetForm& form, real angle, real (&q)[4]) {
  const Phasor one = phasor(angle);
  Phasor now{broadcast(1), broadcast(0)};
  for (int i = 0; i < 4; ++i) q[i] = broadcast(form.cosine[0][i]);
  for (int k = 1; k <= form.harmonics; ++k) {
    now = now * one;
    for (int i = 0; i < 4; ++i)
      q[i] = fma(now.c, broadcast(form.cosine[k][i]), fma(now.s, broadcast(form.sine[k][i]), q[i]));
  }
}
/// Fields of one period.
inline Vector through_periodic(const SpinZone& zone, real phase, real t, real stay, const Vector& s) {
  const FloquetForm& form = zone.floquet;
  const real in = fma(broadcast(form.omega), t, phase - zone.drive[0].phase);
  real q[4];
  periodic_part(form, in, q);
  Vector r = turned_by_quaternion(q, true, s);
  r = turned_about({broadcast(form.axis[0]), broadcast(form.axis[1]), broadcast(form.axis[2])},
                   stay * form.rate, r);
  periodic_part(form, fma(broadcast(form.omega), stay, in), q);
  return turned_by_quaternion(q, false, r);
}

/// Any sum of fields: fourth-order steps in the laboratory.
inline Vector through_any(const SpinZone& zone, const real* phases, real t, real stay, const Way& way,
                          const Vector& s) {
  return in_steps(zone, t, stay, s, [&](real h) {
    return [&, h](real from, const Vector& now) { return step_spin(zone, phases, t, way, from, h, now); };
  });
}

/// Whether fields differ across the beam.
RABILINE_LANES bool differs_across(const SpinZone& zone) {
  for (int k = 0; k < zone.drives; ++k)
    if (const Slopes& s = zone.drive[k].slopes;
        s.phase_x != 0 || s.phase_z != 0 || s.size_x != 0 || s.size_z != 0)
      return true;
  return false;
}

/// The way of particles i... through a zone; across the beam only where something depends on it.
RABILINE_LANES Way way_through(const SpinZone& zone, const BatchView& batch, int i, real slowness) {
  Way way{broadcast(zone.begin), 1.0 / slowness, broadcast(0), broadcast(0)};
  if (!differs_across(zone)) return way;
  const real from = (zone.begin - batch.y) * slowness;
  const real vx = load(batch.vx + i), vz = load(batch.vz + i);
  way.ax = batch.fall.x;
  way.az = batch.fall.z;
  way.x = Way::across(load(batch.x + i), vx, way.ax, from);
  way.z = Way::across(load(batch.z + i), vz, way.az, from);
  way.vx = fma(broadcast(way.ax), from, vx);
  way.vz = fma(broadcast(way.az), from, vz);
  return way;
}

/// The spin after a zone, entered at time t by a straight flight.
inline Vector through_zone(const SpinZone& zone, const RandomKey& key, const BatchView& batch, int i, real t,
                           real slowness, const Vector& s) {
  const real stay = slowness * (zone.end - zone.begin);
  const words particle = load(batch.particle + i);
  real phases[most_drives];
  for (int k = 0; k < zone.drives; ++k) phases[k] = oscillator_phase(zone.drive[k], key, particle);
  if (zone.kind == ZoneKind::periodic) return through_periodic(zone, phases[0], t, stay, s);
  if (zone.kind == ZoneKind::general)
    return through_any(zone, phases, t, stay, way_through(zone, batch, i, slowness), s);
  Vector r = to_frame(zone, s);
  if (zone.kind == ZoneKind::precession)
    r = turn_about_z(phasor(stay * zone.spin_rate), r);
  else if (zone.kind == ZoneKind::profiled)
    r = through_profiled(zone, phases[0], t, stay, way_through(zone, batch, i, slowness), r);
  else if (zone.drive[0].twist != 0)
    r = through_twisted(zone, phases[0], t, stay, slowness, r);
  else
    r = through_rotating(zone, phases[0], t, stay, r);
  return from_frame(zone, r);
}

/// The spin of particles i... after straight flight through the zones, from the batch's common plane with the
/// slowness [s/m] of each: the image of z under `quantum`, else the spin itself.
inline Vector spin_after(const SpinZone* zones, int zone_count, const RandomKey& key, const BatchView& batch,
                         int i, real slowness) {
  Vector s{load(batch.sx + i), load(batch.sy + i), load(batch.sz + i)};
  const real t0 = load(batch.t + i);
  for (int k = 0; k < zone_count; ++k) {
    const real t = fma(broadcast(zones[k].begin - batch.y), slowness, t0);
    s = through_zone(zones[k], key, batch, i, t, slowness, s);
  }
  return s;
}

}  // namespace rabiline::RABILINE_ISA
