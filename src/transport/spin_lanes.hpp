#pragma once
// Spins through the fields of a straight flight, for kernels only.
#include "transport/vector_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// The spin after a zone that it enters at time t and leaves after `stay`, turned exactly: in the frame that
/// turns with the field at omega, the spin turns about (w1, 0, w0 - omega).
inline Vector through_rotating(const SpinZone& zone, const real* phases, real t, real stay, const Vector& s) {
  const DriveTerm& drive = zone.drive[0];
  const double detuned = zone.spin_rate - drive.omega;
  const double rate = __builtin_sqrt(detuned * detuned + drive.spin_rate * drive.spin_rate);
  const Phasor in = phasor(fma(broadcast(drive.omega), t, phases[0]));
  Vector r = turn_back_about_z(in, s);
  if (rate > 0) r = rotation_in_xz_axis(drive.spin_rate / rate, detuned / rate, stay * rate) * r;
  return turn_about_z(phasor(stay * drive.omega), turn_about_z(in, r));
}

/// Several fields that turn at different rates: fourth-order steps, as many as each particle's stay asks for.
inline Vector through_many(const SpinZone& zone, const real* phases, real t, real stay, Vector s) {
  const real steps = max(broadcast(1), -floor(stay * (-1 / zone.step)));
  const real h = stay / steps;
  for (real i = broadcast(0); any(i < steps); i = i + 1.0)
    s = select(i < steps, step_spin(zone, phases, fma(h, i, t), h, s), s);
  return s;
}

inline Vector through_zone(const SpinZone& zone, const RandomKey& key, words particle, real t, real stay,
                           const Vector& s) {
  if (zone.drives == 0) return turn_about_z(phasor(stay * zone.spin_rate), s);
  real phases[most_drives];
  for (int i = 0; i < zone.drives; ++i) phases[i] = oscillator_phase(zone.drive[i], key, particle);
  return zone.drives == 1 ? through_rotating(zone, phases, t, stay, s)
                          : through_many(zone, phases, t, stay, s);
}

/// The spin of particles i... after straight flight through the zones, from the batch's common plane with the
/// slowness [s/m] of each: the image of z under `quantum`, else the spin itself.
inline Vector spin_after(const SpinZone* zones, int zone_count, const RandomKey& key, const BatchView& batch,
                         int i, real slowness) {
  Vector s{load(batch.sx + i), load(batch.sy + i), load(batch.sz + i)};
  const real t0 = load(batch.t + i);
  for (int k = 0; k < zone_count; ++k) {
    const SpinZone& zone = zones[k];
    const real t = fma(broadcast(zone.begin - batch.y), slowness, t0);
    s = through_zone(zone, key, load(batch.particle + i), t, slowness * (zone.end - zone.begin), s);
  }
  return s;
}

}  // namespace rabiline::RABILINE_ISA
