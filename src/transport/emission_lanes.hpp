#pragma once
// What a source draws with, for kernels only: uniform and normal numbers, tables, the axis of its directions.
#include "transport/vector_lanes.hpp"

namespace rabiline::RABILINE_ISA {

constexpr double two_pi = 6.283185307179586;

RABILINE_LANES real uniform_pair(words particle, const RandomKey& key, unsigned use, unsigned draw,
                                 real& second) {
  real first;
  uniforms(particle, key.seed, use, draw, key.stream, first, second);
  return first;
}

/// Two independent standard normal variables from two uniform ones (Box and Muller 1958).
RABILINE_LANES void normal_pair(real u0, real u1, real& a, real& b) {
  const real r = sqrt(-2.0 * log(u0));
  const Phasor p = phasor(u1 * two_pi);
  a = r * p.c;
  b = r * p.s;
}

/// When a particle leaves a pulsed source [s].
inline real start_time(const PulseDraw& pulse, const RandomKey& key, words particle) {
  real u1, normal, unused;
  const real u0 = uniform_pair(particle, key, purpose::emission_time, 0, u1);
  normal_pair(u0, u1, normal, unused);
  return (pulse.kind == PulseKind::rectangle ? u0 : normal) * pulse.width;
}

/// A point uniform in the opening.
RABILINE_LANES void draw_point(const Aperture& a, real u0, real u1, real& x, real& z) {
  if (a.radius >= 0) {
    const double inner2 = a.inner * a.inner;
    const real r = inner2 == 0 ? sqrt(u0) * a.radius
                               : sqrt(fma(u0, broadcast(a.radius * a.radius - inner2), broadcast(inner2)));
    const Phasor p = phasor(u1 * two_pi);
    x = fma(r, p.c, broadcast(a.x0));
    z = fma(r, p.s, broadcast(a.z0));
    return;
  }
  const real across = fma(u0, broadcast(2), broadcast(-1)) * a.half_x,
             up = fma(u1, broadcast(2), broadcast(-1)) * a.half_z;
  if (a.sine == 0) {
    x = across + a.x0;
    z = up + a.z0;
  } else {
    x = fma(across, broadcast(a.cosine), fma(up, broadcast(a.sine), broadcast(a.x0)));
    z = fma(up, broadcast(a.cosine), fma(across, broadcast(-a.sine), broadcast(a.z0)));
  }
}

inline double drawn_from(const SampledLaw& law, double u) {
  int cell = law.guide[static_cast<int>(u * SampledLaw::guides)];
  while (law.cumulative[cell + 1] < u) ++cell;
  if (law.density == nullptr) return law.at[cell];
  // With f0 and f1 at the ends, the share t of the cell's width below which a share s of it lies:
  // (f0 + (f1 - f0) t/2) t = s (f0 + f1)/2.
  const double f0 = law.density[cell], f1 = law.density[cell + 1];
  const double s = (u - law.cumulative[cell]) / (law.cumulative[cell + 1] - law.cumulative[cell]);
  const double t = s * (f0 + f1) / (f0 + __builtin_sqrt(f0 * f0 + s * (f1 * f1 - f0 * f0)));
  return law.at[cell] + t * (law.at[cell + 1] - law.at[cell]);
}
/// One particle after the other, with plain arithmetic: the same bits on every instruction set.
inline real drawn_from(const SampledLaw& law, real u) {
  real out{};
  for (int k = 0; k < lane_count; ++k) set_lane(out, k, drawn_from(law, lane(u, k)));
  return out;
}

/// A weight from 0 to 1: the integer stands in the low bits.
RABILINE_LANES words quanta_of(real weight) {
  const real quanta = weight * static_cast<double>(quanta_per_particle);
  return (words)(round_to_nearest(quanta) + 0x1p52) & 0xfffffffffffffULL;
}

/// Turned right-handed about x, from +y towards +z, then about z, from +x towards +y.
inline Vector tilted(const Emission& e, const Vector& d) {
  const real y = fma(d.y, broadcast(e.tilt_cos_x), -(d.z * e.tilt_sin_x)),
             z = fma(d.y, broadcast(e.tilt_sin_x), d.z * e.tilt_cos_x);
  return {fma(d.x, broadcast(e.tilt_cos_z), -(y * e.tilt_sin_z)),
          fma(d.x, broadcast(e.tilt_sin_z), y * e.tilt_cos_z), z};
}

inline double shape_at(const ChannelShape& s, double tangent) {
  const double p = tangent / s.edge;
  const double* j = p < 1 ? s.inside : s.outside;
  const double at = (p < 1 ? p : 1 / p) * s.cells;
  const int cell = at < s.cells - 1 ? static_cast<int>(at) : s.cells - 1;
  return j[cell] + (at - cell) * (j[cell + 1] - j[cell]);
}
inline real shape_at(const ChannelShape& s, real tangent) {
  real out{};
  for (int k = 0; k < lane_count; ++k) set_lane(out, k, shape_at(s, lane(tangent, k)));
  return out;
}

/// Density per solid angle of an aimed source in the direction d, relative to that along its axis n:
/// cos(theta), or j(theta) cos(theta). Nothing starts backwards.
inline real relative_density(const Emission& e, const Vector& d) {
  const real zero = broadcast(0);
  const Vector n = tilted(e, {zero, broadcast(1), zero});
  const real along = dot(d, n), cosine = min(broadcast(1), max(zero, along));
  if (e.direction.aimed_law == AimedLaw::isotropic) return select(along > zero, broadcast(1), zero);
  if (e.direction.aimed_law == AimedLaw::cosine) return cosine;
  const Vector across = cross(d, n);
  const real sine = sqrt(dot(across, across));
  return select(along > zero, shape_at(e.direction.channel, sine / max(along, broadcast(1e-300))) * cosine,
                zero);
}

}  // namespace rabiline::RABILINE_ISA
