#pragma once
// Three-vectors of lanes and their rotations, for kernels only (see core/lanes.hpp).
#include "core/lanes.hpp"
#include "core/random_lanes.hpp"
#include "transport/kernels.hpp"

namespace rabiline::RABILINE_ISA {

struct Vector {
  real x, y, z;
};

RABILINE_LANES Vector cross(const Vector& a, const Vector& b) {
  return {fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x))};
}
RABILINE_LANES real dot(const Vector& a, const Vector& b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }
/// a + s b
RABILINE_LANES Vector add(const Vector& a, real s, const Vector& b) {
  return {fma(s, b.x, a.x), fma(s, b.y, a.y), fma(s, b.z, a.z)};
}
RABILINE_LANES Vector select(mask m, const Vector& a, const Vector& b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

/// An angle in the xy plane as (cos, sin).
struct Phasor {
  real c, s;
};
RABILINE_LANES Phasor phasor(real angle) {
  Phasor p;
  sincos(angle, p.s, p.c);
  return p;
}
RABILINE_LANES Phasor operator*(const Phasor& a, const Phasor& b) {
  return {fma(a.c, b.c, -(a.s * b.s)), fma(a.c, b.s, a.s * b.c)};
}
/// Turned by the angle about +z, right-handed: from +x towards +y.
RABILINE_LANES Vector turn_about_z(const Phasor& p, const Vector& v) {
  return {fma(p.c, v.x, -(p.s * v.y)), fma(p.s, v.x, p.c * v.y), v.z};
}
RABILINE_LANES Vector turn_back_about_z(const Phasor& p, const Vector& v) {
  return {fma(p.c, v.x, p.s * v.y), fma(p.c, v.y, -(p.s * v.x)), v.z};
}

/// Nine numbers of a rotation, row by row.
struct Matrix {
  real m[9];
};
RABILINE_LANES Vector operator*(const Matrix& a, const Vector& v) {
  return {fma(a.m[0], v.x, fma(a.m[1], v.y, a.m[2] * v.z)), fma(a.m[3], v.x, fma(a.m[4], v.y, a.m[5] * v.z)),
          fma(a.m[6], v.x, fma(a.m[7], v.y, a.m[8] * v.z))};
}
/// Right-handed rotation about the unit vector (ux, 0, uz), from cosine and sine of half its angle.
RABILINE_LANES Matrix rotation_in_xz_axis(double ux, double uz, const Phasor& half) {
  const real d = 2.0 * half.s * half.s, c = 1.0 - d, s = 2.0 * half.s * half.c;  // d without loss, if small
  const real x = broadcast(ux), z = broadcast(uz);
  return {{fma(x * x, d, c), -(z * s), x * z * d,  //
           z * s, c, -(x * s),                     //
           x * z * d, x * s, fma(z * z, d, c)}};
}
RABILINE_LANES Matrix rotation_in_xz_axis(double ux, double uz, real angle) {
  return rotation_in_xz_axis(ux, uz, phasor(0.5 * angle));
}
/// Rotates v by the rotation vector o, |o| <= 1.
RABILINE_LANES Vector rotate(const Vector& o, const Vector& v) {
  real S, C;
  rotation_coefficients(dot(o, o), S, C);
  const Vector u = cross(o, v);
  return add(add(v, S, u), C, cross(o, u));
}
/// S turned by the rotation vector o of any length.
RABILINE_LANES Vector turned_by(const Vector& o, const Vector& v) {
  const real q = dot(o, o);
  const mask far = q > broadcast(1);
  real sine, cosine;
  rotation_coefficients(min(q, broadcast(1)), sine, cosine);
  if (any(far)) {
    const real angle = sqrt(select(far, q, broadcast(1)));
    real s, c, half_s, half_c;
    sincos(angle, s, c);
    sincos(0.5 * angle, half_s, half_c);
    sine = select(far, s / angle, sine);
    cosine = select(far, 2.0 * half_s * half_s / (angle * angle), cosine);
  }
  const Vector u = cross(o, v);
  return add(add(v, sine, u), cosine, cross(o, u));
}
/// The mean of v while it turns by o at an even rate: v + (1 - cos a)/a^2 o x v + (a - sin a)/a^3 o x (o x
/// v).
RABILINE_LANES Vector mean_of_turning(const Vector& o, const Vector& v) {
  const real q = dot(o, o);
  real sine, cosine;
  rotation_coefficients(q, sine, cosine);
  const real minus_integral = polynomial(q, {-1.0 / 1307674368000, 1.0 / 6227020800, -1.0 / 39916800,
                                             1.0 / 362880, -1.0 / 5040, 1.0 / 120, -1.0 / 6});
  const Vector u = cross(o, v);
  return add(add(v, cosine, u), -minus_integral, cross(o, u));
}

/// Random phase of an oscillator at each particle's emission.
RABILINE_LANES real oscillator_phase(const DriveTerm& drive, const RandomKey& key, words particle) {
  if (drive.oscillator < 0) return broadcast(drive.phase);
  real u, unused;
  uniforms(particle, key.seed, purpose::oscillator, static_cast<unsigned>(drive.oscillator), key.stream, u,
           unused);
  return fma(u, broadcast(drive.random_turn), broadcast(drive.phase));
}

/// Angle of a drive at time t and place y, from its phase at emission.
RABILINE_LANES real angle_at(const DriveTerm& drive, real phase, real t, real y) {
  const real angle = fma(broadcast(drive.omega), t, phase);
  return drive.twist == 0 ? angle : fma(broadcast(drive.twist), y - drive.envelope.begin, angle);
}
/// The share of a field's highest size at place y, and what it grows by along the beam [1/m].
struct ShareHere {
  real share, slope;
};
RABILINE_LANES ShareHere share_here(const Envelope& envelope, real y) {
  constexpr double pi = 3.141592653589793;
  if (envelope.shape == Shape::rectangular) return {broadcast(1), broadcast(0)};
  real s, c;
  if (envelope.shape == Shape::half_sine) {
    sincos((y - envelope.begin) * (pi / envelope.length), s, c);
    return {s, c * (pi / envelope.length)};
  }
  if (envelope.shape == Shape::standing_wave) {
    const double per_length = envelope.half_waves * pi / envelope.length;
    sincos((y - envelope.begin) * per_length, s, c);
    return envelope.is_cosine ? ShareHere{c, s * -per_length} : ShareHere{s, c * per_length};
  }
  const real off = (y - (envelope.begin + 0.5 * envelope.length)) * (1 / envelope.sigma),
             share = exp(off * off * -0.5);
  return {share, share * off * (-1 / envelope.sigma)};
}
RABILINE_LANES real share_of(const Envelope& envelope, real y) { return share_here(envelope, y).share; }

/// What a sweep has added to omega by the time t.
RABILINE_LANES real swept_rate(const Sweep& sweep, real t) {
  return sweep.rate * max(broadcast(0), min(t - sweep.begin, broadcast(sweep.end - sweep.begin)));
}
/// And to the angle.
RABILINE_LANES real swept_angle(const Sweep& sweep, real t) {
  const double all = sweep.end - sweep.begin;
  const real within = max(broadcast(0), min(t - sweep.begin, broadcast(all)));
  return sweep.rate * fma(0.5 * within, within, all * max(broadcast(0), t - sweep.end));
}
/// The begin of the last time before t that a gate opens, or of its first.
RABILINE_LANES real opening_before(const Gate& gate, real t) {
  const real begin = broadcast(gate.begin);
  if (!(gate.period > 0)) return begin;
  const real number = floor((t - begin) * (1 / gate.period));
  return fma(max(broadcast(0), min(number, broadcast(gate.times - 1))), broadcast(gate.period), begin);
}
/// Whether a zone's drives are switched or swept.
RABILINE_LANES bool is_switched(const SpinZone& zone) {
  for (int k = 0; k < zone.drives; ++k)
    if (zone.drive[k].sweep.rate != 0 || zone.drive[k].gate.begin != zone.drive[k].gate.end) return true;
  return false;
}
/// Nearest moment after t at which a drive changes for others than reasons of place, at most `latest`.
RABILINE_LANES real next_change(const DriveTerm& drive, real t, real latest) {
  const auto consider = [&](real moment) { latest = select(moment > t, min(moment, latest), latest); };
  if (drive.sweep.rate != 0) {
    consider(broadcast(drive.sweep.begin));
    consider(broadcast(drive.sweep.end));
  }
  const Gate& gate = drive.gate;
  if (gate.begin == gate.end) return latest;
  // Rounding may put t behind an edge before which it stands: one period farther is looked at, too.
  const real opens = opening_before(gate, t), width = broadcast(gate.end - gate.begin);
  const real last = broadcast(gate.begin + (gate.times - 1) * gate.period);
  consider(opens);
  consider(opens + width);
  if (gate.period > 0) {
    const real again = min(opens + gate.period, last);
    consider(again);
    consider(again + width);
  }
  return latest;
}
/// Angle of a drive at time t and place r.
RABILINE_LANES real angle_at(const DriveTerm& drive, real phase, real t, const Vector& r) {
  real angle = angle_at(drive, phase, t, r.y);
  if (drive.sweep.rate != 0) angle = angle + swept_angle(drive.sweep, t);
  const Slopes& slopes = drive.slopes;
  if (slopes.phase_x != 0) angle = fma(broadcast(slopes.phase_x), r.x - slopes.x, angle);
  if (slopes.phase_z != 0) angle = fma(broadcast(slopes.phase_z), r.z - slopes.z, angle);
  return angle;
}
/// Whether its size is the same everywhere and always.
RABILINE_LANES bool has_one_size(const DriveTerm& drive) {
  return drive.envelope.shape == Shape::rectangular && drive.gate.begin == drive.gate.end &&
         drive.slopes.size_x == 0 && drive.slopes.size_z == 0;
}
/// Whether a field that is switched is on at the time t.
RABILINE_LANES mask is_on(const Gate& gate, real t) {
  const real since = t - opening_before(gate, t);
  return (since >= broadcast(0)) & (since < broadcast(gate.end - gate.begin));
}
/// While it is on, the share of its highest size on the axis at place r.
RABILINE_LANES real share_of(const DriveTerm& drive, const Vector& r) {
  const real share = share_of(drive.envelope, r.y);
  const Slopes& slopes = drive.slopes;
  if (slopes.size_x == 0 && slopes.size_z == 0) return share;
  return share * fma(broadcast(slopes.size_x), r.x - slopes.x,
                     fma(broadcast(slopes.size_z), r.z - slopes.z, broadcast(1)));
}
/// The same at time t.
RABILINE_LANES real share_of(const DriveTerm& drive, real t, const Vector& r) {
  const real share = share_of(drive, r);
  const Gate& gate = drive.gate;
  return gate.begin == gate.end ? share : select(is_on(gate, t), share, broadcast(0));
}

RABILINE_LANES Vector third_axis(const SpinZone& zone) {
  return {broadcast(zone.frame[6]), broadcast(zone.frame[7]), broadcast(zone.frame[8])};
}
RABILINE_LANES Vector to_frame(const SpinZone& zone, const Vector& v) {
  if (!zone.turned) return v;
  const double* f = zone.frame;
  return {fma(v.x, broadcast(f[0]), fma(v.y, broadcast(f[1]), v.z * f[2])),
          fma(v.x, broadcast(f[3]), fma(v.y, broadcast(f[4]), v.z * f[5])),
          fma(v.x, broadcast(f[6]), fma(v.y, broadcast(f[7]), v.z * f[8]))};
}
RABILINE_LANES Vector from_frame(const SpinZone& zone, const Vector& v) {
  if (!zone.turned) return v;
  const double* f = zone.frame;
  return {fma(v.x, broadcast(f[0]), fma(v.y, broadcast(f[3]), v.z * f[6])),
          fma(v.x, broadcast(f[1]), fma(v.y, broadcast(f[4]), v.z * f[7])),
          fma(v.x, broadcast(f[2]), fma(v.y, broadcast(f[5]), v.z * f[8]))};
}

/// The fields of a zone as angular velocities, summed over drives whose phases at emission are given, and
/// where `on` is given which of them are switched on.
struct Rates {
  Vector spin, turn;
};
RABILINE_LANES Rates rates_at(const SpinZone& zone, const real* phases, real t, const Vector& place,
                              const mask* on = nullptr) {
  const real zero = broadcast(0), spin_rate = broadcast(zone.spin_rate),
             turn_rate = broadcast(zone.turn_rate);
  Rates r{{zero, zero, spin_rate}, {zero, zero, turn_rate}};
  if (zone.turned) {
    const Vector axis = third_axis(zone);
    r = {{spin_rate * axis.x, spin_rate * axis.y, spin_rate * axis.z},
         {turn_rate * axis.x, turn_rate * axis.y, turn_rate * axis.z}};
  }
  for (int i = 0; i < zone.drives; ++i) {
    const DriveTerm& drive = zone.drive[i];
    Phasor p = phasor(angle_at(drive, phases[i], t, place));
    if (!has_one_size(drive)) {
      const real size =
          on == nullptr ? share_of(drive, t, place) : select(on[i], share_of(drive, place), broadcast(0));
      p = {p.c * size, p.s * size};
    }
    const real spin = broadcast(drive.spin_rate), turn = broadcast(drive.turn_rate);
    if (drive.in_xy) {
      r.spin.x = fma(spin, p.c, r.spin.x);
      r.spin.y = fma(spin, p.s, r.spin.y);
      r.turn.x = fma(turn, p.c, r.turn.x);
      r.turn.y = fma(turn, p.s, r.turn.y);
      continue;
    }
    const double *a = drive.first, *b = drive.second;
    const Vector along{fma(p.c, broadcast(a[0]), p.s * b[0]), fma(p.c, broadcast(a[1]), p.s * b[1]),
                       fma(p.c, broadcast(a[2]), p.s * b[2])};
    r.spin = add(r.spin, spin, along);
    r.turn = add(r.turn, turn, along);
  }
  return r;
}

/// Places of the two Gauss points in a step of length 1, and sqrt(3)/12 of the fourth-order Magnus expansion
/// (Blanes, Casas, Oteo and Ros 2009, eq. 253).
inline constexpr double gauss_first = 0.21132486540518711775, gauss_second = 0.78867513459481288225,
                        magnus_commutator = 0.14433756729740644113;

/// Rotation vector of dS/dt = w(t) x S over a step h from w at the two Gauss points:
/// h (w1 + w2)/2 + h^2 sqrt(3)/12 w2 x w1.
RABILINE_LANES Vector magnus(const Vector& w1, const Vector& w2, real h) {
  const Vector c = cross(w2, w1);
  const real half = 0.5 * h, k = broadcast(magnus_commutator) * h * h;
  return {fma(k, c.x, half * (w1.x + w2.x)), fma(k, c.y, half * (w1.y + w2.y)),
          fma(k, c.z, half * (w1.z + w2.z))};
}
/// Where a particle is dt after a moment: along the beam y + v dt + a dt^2/2 + ..., across it on a
/// parabola.
struct Way {
  real y, v, half_a, sixth_jerk;
  real x{}, z{}, vx{}, vz{};
  double ax = 0, az = 0;  // [m/s^2]
  RABILINE_LANES real at(real dt) const { return fma(fma(fma(sixth_jerk, dt, half_a), dt, v), dt, y); }
  RABILINE_LANES Vector place(real dt) const {
    return {across(x, vx, ax, dt), at(dt), across(z, vz, az, dt)};
  }
  RABILINE_LANES static real across(real x, real v, double a, real dt) {
    return fma(fma(broadcast(0.5 * a), dt, v), dt, x);
  }
};
/// The spin one Magnus step later, for any sum of fields; the step begins `from` after the time t0 of the
/// way.
RABILINE_LANES Vector step_spin(const SpinZone& zone, const real* phases, real t0, const Way& way, real from,
                                real h, const Vector& s) {
  const real dt1 = fma(broadcast(gauss_first), h, from), dt2 = fma(broadcast(gauss_second), h, from);
  const Vector w1 = rates_at(zone, phases, t0 + dt1, way.place(dt1)).spin;
  const Vector w2 = rates_at(zone, phases, t0 + dt2, way.place(dt2)).spin;
  return rotate(magnus(w1, w2, h), s);
}

}  // namespace rabiline::RABILINE_ISA
