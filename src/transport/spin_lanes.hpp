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

/// Calls step(i, h, from) for as many equal steps as each particle's stay asks for.
template <class Step>
RABILINE_LANES Vector in_steps(const SpinZone& zone, real stay, Vector s, const Step& step) {
  const real steps = max(broadcast(1), -floor(stay * (-1 / zone.step)));
  const real h = stay / steps;
  for (real i = broadcast(0); any(i < steps); i = i + 1.0) s = select(i < steps, step(h * i, h, s), s);
  return s;
}

/// A field whose size runs along the beam: fourth-order steps in the frame that turns with it.
inline Vector through_profiled(const SpinZone& zone, real phase, real t, real stay, real slowness,
                               const Vector& s) {
  const DriveTerm& drive = zone.drive[0];
  const real v = 1.0 / slowness, omega = broadcast(drive.omega) + drive.twist * v,
             detuned = zone.spin_rate - omega;
  const Phasor in = phasor(angle_at(drive, phase, t, broadcast(zone.begin)));
  const Vector r = in_steps(zone, stay, turn_back_about_z(in, s), [&](real from, real h, const Vector& now) {
    const real y1 = fma(fma(broadcast(gauss_first), h, from), v, broadcast(zone.begin)),
               y2 = fma(fma(broadcast(gauss_second), h, from), v, broadcast(zone.begin));
    const real zero = broadcast(0);
    const Vector w1{drive.spin_rate * share_of(drive.envelope, y1), zero, detuned},
        w2{drive.spin_rate * share_of(drive.envelope, y2), zero, detuned};
    return rotate(magnus(w1, w2, h), now);
  });
  return turn_about_z(phasor(stay * omega), turn_about_z(in, r));
}

/// Any sum of fields: fourth-order steps in the laboratory.
inline Vector through_any(const SpinZone& zone, const real* phases, real t, real stay, real slowness,
                          const Vector& s) {
  const Way way{broadcast(zone.begin), 1.0 / slowness, broadcast(0), broadcast(0)};
  return in_steps(zone, stay, s, [&](real from, real h, const Vector& now) {
    return step_spin(zone, phases, t, way, from, h, now);
  });
}

/// The spin after a zone, entered at time t by a straight flight.
inline Vector through_zone(const SpinZone& zone, const RandomKey& key, words particle, real t, real slowness,
                           const Vector& s) {
  const real stay = slowness * (zone.end - zone.begin);
  real phases[most_drives];
  for (int i = 0; i < zone.drives; ++i) phases[i] = oscillator_phase(zone.drive[i], key, particle);
  if (zone.kind == ZoneKind::general) return through_any(zone, phases, t, stay, slowness, s);
  Vector r = to_frame(zone, s);
  if (zone.kind == ZoneKind::precession)
    r = turn_about_z(phasor(stay * zone.spin_rate), r);
  else if (zone.kind == ZoneKind::profiled)
    r = through_profiled(zone, phases[0], t, stay, slowness, r);
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
    s = through_zone(zones[k], key, load(batch.particle + i), t, slowness, s);
  }
  return s;
}

}  // namespace rabiline::RABILINE_ISA
