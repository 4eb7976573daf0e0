#pragma once
// Levels where the field passes by zero, for kernels only.
#include "transport/level_jump_lanes.hpp"
#include "transport/level_path_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// [rad] By how much levels turn at the most while a field passes by zero at some distance, from one place to
/// another `time` later where +-B is followed with the other sign; nothing where the sign stays.
inline real angle_passing_zero(const FollowedField& from, const FollowedField& to, real time) {
  const Vector before = times(from.signed_size, from.n), behind = times(to.signed_size, to.n);
  const real change = max(length_of(add(behind, broadcast(-1), before)), broadcast(tiny)),
             distance = length_of(cross(before, behind)) / change,
             angle = electron_rate * time * distance * (distance / change);
  const mask turns_over = (from.signed_size < broadcast(0)) != (to.signed_size < broadcast(0));
  return select(turns_over, angle, broadcast(0));
}

/// A step through what a field has along the axis.
struct AlongAxis {
  mask lanes;         // in which what it has across the axis is too weak to be felt
  real error;         // of the step
  FieldAtTime field;  // at the end
  Vector along;       // [T] of it
};
/// However the field turns in the step: as close to zero as it may come, its size changes as fast as ever, by
/// which it drives what differs in F.
[[gnu::noinline]] inline AlongAxis follow_along_axis(const LevelManifold& f, const LevelPath& path,
                                                     const CourseSection& section, real s, real h,
                                                     const LevelAxes& axes, mask lanes, Amplitudes& a) {
  AlongAxis out{lanes, broadcast(0), {}, {}};
  LevelMatrix at[5];
  for (int i = 0; i < 5; ++i) {
    out.field = path.field_at(section, fma(broadcast(0.5 + 0.5 * lobatto_point[i]), h, s));
    out.along = times(dot(out.field.b, axes.third), axes.third);
    out.lanes = out.lanes & path.is_unfelt(length_of(add(out.field.b, broadcast(-1), out.along)), h);
    if (!any(out.lanes)) return out;
    FollowedField there = followed({out.along, out.field.rate}, axes);
    there.turn_1 = there.turn_2 = there.turn_3 = broadcast(0);
    set_matrix(f, there, at[i]);
  }
  out.lanes = out.lanes & step_through(f, h, true, at, a, out.error);
  return out;
}

}  // namespace rabiline::RABILINE_ISA
