#pragma once
// Fields that differ from place to place and may swing, for kernels only.
#include "field/lane_maths.hpp"
#include "field/shaped_field.hpp"
#include "transport/vector_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// Adds a field that stands, or swings as B(r) cos(angle) with the angle of a drive of its zone. Returns what
/// it changes by in time at one place [T/s]: -B(r) sin(angle) d(angle)/dt.
inline Vector add_field_at(const ShapedTerm& term, const SpinZone& zone, const real* phases, real t,
                           const Vector& r, FieldHere<real>& sum) {
  if (term.drive < 0) {
    add_field<LaneMaths>(term, r.x, r.y, r.z, sum);
    return {broadcast(0), broadcast(0), broadcast(0)};
  }
  const DriveTerm& drive = zone.drive[term.drive];
  const Phasor p = phasor(angle_at(drive, phases[term.drive], t, r));
  FieldHere<real> peak{};
  add_field<LaneMaths>(term, r.x, r.y, r.z, peak);
  for (int k = 0; k < 3; ++k) sum.field[k] = fma(p.c, peak.field[k], sum.field[k]);
  for (int k = 0; k < 9; ++k) sum.slope[k] = fma(p.c, peak.slope[k], sum.slope[k]);
  const real rate = -drive.omega * p.s;
  return {rate * peak.field[0], rate * peak.field[1], rate * peak.field[2]};
}

}  // namespace rabiline::RABILINE_ISA
