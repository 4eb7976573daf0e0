#pragma once
// Fields that differ from place to place and may swing, for kernels only.
#include "field/lane_maths.hpp"
#include "field/shaped_field.hpp"
#include "transport/vector_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// Adds a field that stands, or swings as B(r) cos(angle) with the angle of a drive of its zone, or follows a
/// course in time. Returns what it changes by in time at one place [T/s].
inline Vector add_field_at(const ShapedTerm& term, const SpinZone& zone, const real* phases, real t,
                           const Vector& r, FieldHere<real>& sum) {
  if (term.drive < 0 && term.course.nodes == 0) {
    add_field<LaneMaths>(term, r.x, r.y, r.z, sum);
    return {broadcast(0), broadcast(0), broadcast(0)};
  }
  CourseHere<real> now;
  if (term.drive < 0) {
    now = course_at<LaneMaths>(term.course, t);
  } else {
    const DriveTerm& drive = zone.drive[term.drive];
    const Phasor p = phasor(angle_at(drive, phases[term.drive], t, r));
    const real turning =
        drive.sweep.rate == 0 ? broadcast(drive.omega) : drive.omega + swept_rate(drive.sweep, t);
    now = {p.c, -turning * p.s};
  }
  FieldHere<real> peak{};
  add_field<LaneMaths>(term, r.x, r.y, r.z, peak);
  for (int k = 0; k < 3; ++k) sum.field[k] = fma(now.share, peak.field[k], sum.field[k]);
  for (int k = 0; k < 9; ++k) sum.slope[k] = fma(now.share, peak.slope[k], sum.slope[k]);
  return {now.rate * peak.field[0], now.rate * peak.field[1], now.rate * peak.field[2]};
}

}  // namespace rabiline::RABILINE_ISA
