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
/// Right-handed rotation by `angle` about the unit vector (ux, 0, uz).
RABILINE_LANES Matrix rotation_in_xz_axis(double ux, double uz, real angle) {
  real s, c;
  sincos(angle, s, c);
  real half_s, half_c;
  sincos(angle * 0.5, half_s, half_c);
  const real d = 2.0 * half_s * half_s;  // 1 - cos, without loss for small angles
  const real x = broadcast(ux), z = broadcast(uz);
  return {{fma(x * x, d, c), -(z * s), x * z * d,  //
           z * s, c, -(x * s),                     //
           x * z * d, x * s, fma(z * z, d, c)}};
}
/// Rotates v by the rotation vector o, |o| <= 1.
RABILINE_LANES Vector rotate(const Vector& o, const Vector& v) {
  real S, C;
  rotation_coefficients(dot(o, o), S, C);
  const Vector u = cross(o, v);
  return add(add(v, S, u), C, cross(o, u));
}

/// Random phase of an oscillator at each particle's emission, in [0, 2 pi).
RABILINE_LANES real oscillator_phase(const DriveTerm& drive, const RandomKey& key, words particle) {
  if (drive.oscillator < 0) return broadcast(drive.phase);
  real u, unused;
  uniforms(particle, key.seed, purpose::oscillator, static_cast<unsigned>(drive.oscillator), key.stream, u,
           unused);
  return fma(u, broadcast(6.283185307179586), broadcast(drive.phase));
}

/// The fields of a zone as angular velocities, summed over drives whose phases at emission are given.
struct Rates {
  Vector spin, turn;
};
RABILINE_LANES Rates rates_at(const SpinZone& zone, const real* phases, real t) {
  const real zero = broadcast(0);
  Rates r{{zero, zero, broadcast(zone.spin_rate)}, {zero, zero, broadcast(zone.turn_rate)}};
  for (int i = 0; i < zone.drives; ++i) {
    const Phasor p = phasor(fma(broadcast(zone.drive[i].omega), t, phases[i]));
    const real spin = broadcast(zone.drive[i].spin_rate), turn = broadcast(zone.drive[i].turn_rate);
    r.spin.x = fma(spin, p.c, r.spin.x);
    r.spin.y = fma(spin, p.s, r.spin.y);
    r.turn.x = fma(turn, p.c, r.turn.x);
    r.turn.y = fma(turn, p.s, r.turn.y);
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
/// The spin one Magnus step later, for any sum of rotating fields.
RABILINE_LANES Vector step_spin(const SpinZone& zone, const real* phases, real t, real h, const Vector& s) {
  const Vector w1 = rates_at(zone, phases, fma(broadcast(gauss_first), h, t)).spin;
  const Vector w2 = rates_at(zone, phases, fma(broadcast(gauss_second), h, t)).spin;
  return rotate(magnus(w1, w2, h), s);
}

}  // namespace rabiline::RABILINE_ISA
