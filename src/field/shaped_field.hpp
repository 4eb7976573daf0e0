#pragma once
// B and its nine derivatives at a place, of shaped terms, for any number type: what kernels and the host read
// is one formula. `Maths` (field/host_maths.hpp, field/lane_maths.hpp) has what it needs beyond + - * /.
#include <cmath>
#include <initializer_list>

#include "field/shaped_term.hpp"

namespace rabiline {

template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_of(const LinearShape& linear, Number x, Number y,
                                                         Number z) {
  const Number none = x - x;
  FieldHere<Number> here;
  for (int i = 0; i < 3; ++i) {
    const double* g = &linear.slope[3L * i];
    here.field[i] = x * g[0] + y * g[1] + z * g[2] + linear.field[i];
    for (int k = 0; k < 3; ++k) here.slope[3 * i + k] = none + g[k];
  }
  return here;
}

/// (x, y, z) of the laboratory in the term's own frame.
template <class Number>
[[gnu::always_inline]] inline void own_place(const ShapedTerm& term, const Number& x, const Number& y,
                                             const Number& z, Number (&own)[3]) {
  const Number from[3] = {x - term.x, y - term.y, z - term.z};
  for (int i = 0; i < 3; ++i) {
    const double* axis = &term.axes[3L * i];
    own[i] = term.turned ? from[0] * axis[0] + from[1] * axis[1] + from[2] * axis[2] : from[i];
  }
}

/// Whether its z axis leans away from the y axis of the laboratory.
inline bool is_tilted(const ShapedTerm& term) { return term.axes[6] != 0 || term.axes[8] != 0; }

/// A map that ends what leaves it.
inline bool nothing_may_leave(const ShapedTerm& term) {
  return (term.kind == ShapedKind::map && term.map.outside == MapOutside::error) ||
         (term.kind == ShapedKind::round_map && term.round_map.outside == MapOutside::error);
}

/// 1 beside a map that nothing may leave (`outside: error`), else 0. In front of it and behind, on the beam's
/// way, nothing has left it: of a map that is turned these are the faces that look along the beam most, of a
/// round one across the beam its curved side.
template <class Maths, class Number>
[[gnu::always_inline]] inline Number is_lost(const ShapedTerm& term, const Number& x, const Number& y,
                                             const Number& z) {
  const Number none = x - x;
  Number own[3], inside = none + 1.0;
  own_place(term, x, y, z, own);
  const double beam[3] = {term.turned ? term.axes[1] : 0, term.turned ? term.axes[4] : 1,
                          term.turned ? term.axes[7] : 0};  // along the beam, squared below
  const double along[3] = {beam[0] * beam[0], beam[1] * beam[1], beam[2] * beam[2]};
  if (term.kind == ShapedKind::map && term.map.outside == MapOutside::error) {
    const int through = along[1] >= along[0] && along[1] >= along[2] ? 1 : along[0] >= along[2] ? 0 : 2;
    for (int a = 0; a < 3; ++a)
      if (a != through)
        inside = inside *
                 spline_cell<Maths>(own[a], term.map.begin[a], term.map.scale[a], term.map.nodes[a]).inside;
  }
  if (term.kind == ShapedKind::round_map && term.round_map.outside == MapOutside::error) {
    const RoundMapShape& map = term.round_map;
    if (along[2] > 0.5) {
      inside = spline_cell<Maths>(Maths::root(own[0] * own[0] + own[1] * own[1]), map.begin[0], map.scale[0],
                                  map.nodes[0])
                   .inside;
    } else {
      const double across = std::sqrt(along[0] + along[1]);
      const Number beside = own[0] * (beam[1] / across) - own[1] * (beam[0] / across);
      inside = spline_cell<Maths>(beside, map.begin[0], map.scale[0], map.nodes[0]).inside *
               spline_cell<Maths>(own[2], map.begin[1], map.scale[1], map.nodes[1]).inside;
    }
  }
  return 1.0 - inside;
}

/// The first time after `soonest`, and before `latest`, at which a way from `place` with `velocity` meets a
/// surface where the field of a term jumps or bends sharply: the faces of a map, the windings of a coil, a
/// sheet of current, the skin of a wire, where the curve of a tilted field along its axis begins and ends;
/// else `latest`. A way that an acceleration may bend by up to `bend`
/// is told a time at which it is not there yet, but nearer than the bend amounts to. The edges of sections
/// are not among them.
template <class Maths, class Number>
[[gnu::noinline]] Number time_to_face(const ShapedTerm& term, const Number (&place)[3],
                                      const Number (&velocity)[3], const Number& bend, const Number& soonest,
                                      Number latest) {
  const Number none = latest - latest;
  Number own[3], v[3];
  own_place(term, place[0], place[1], place[2], own);
  for (int i = 0; i < 3; ++i) {
    const double* axis = &term.axes[3L * i];
    v[i] = term.turned ? velocity[0] * axis[0] + velocity[1] * axis[1] + velocity[2] * axis[2] : velocity[i];
  }
  // Straight it would be there at `time` with the speed `nearing`: v t + b t^2/2 = v time has the root below.
  // What only grazes a surface goes on by a sixth of that at least, or it would never be through.
  const auto consider = [&](const Number& time, const Number& nearing) {
    const Number any_bend = bend * time / nearing,
                 bent = Maths::select(any_bend < none + 64, any_bend, none + 64);
    const Number sure = 2.0 * time / (1.0 + Maths::root(1.0 + 2.0 * bent));
    const Number met = Maths::select(bent > none + 1e-7, sure, time);
    latest = Maths::select(time > soonest, Maths::select(met < latest, met, latest), latest);
  };
  const auto plane = [&](int axis, double at) {
    consider((at - own[axis]) / v[axis], v[axis] < none ? -v[axis] : v[axis]);
  };
  const auto planes = [&](int axis, double begin, double scale, int nodes) {
    plane(axis, begin);
    plane(axis, begin + (nodes - 1) / scale);
  };
  const auto cylinder = [&](double radius) {
    const Number a = v[0] * v[0] + v[1] * v[1], b = own[0] * v[0] + own[1] * v[1],
                 c = own[0] * own[0] + own[1] * own[1] - radius * radius, d = b * b - a * c;
    const Number root = Maths::root(Maths::select(d > none, d, none)), per = 1.0 / a,
                 nearing = root * (1 / radius);
    consider(Maths::select(d > none, (none - b - root) * per, none), nearing);
    consider(Maths::select(d > none, (root - b) * per, none), nearing);
  };
  if (term.kind == ShapedKind::map)
    for (int a = 0; a < 3; ++a) planes(a, term.map.begin[a], term.map.scale[a], term.map.nodes[a]);
  if (term.kind == ShapedKind::round_map) {
    planes(2, term.round_map.begin[1], term.round_map.scale[1], term.round_map.nodes[1]);
    cylinder(-term.round_map.begin[0]);
  }
  if (term.kind == ShapedKind::fringed && is_tilted(term) && term.fringed.curve != FringeCurve::enge) {
    const FringeShape& shape = term.fringed;
    const double beside = shape.curve == FringeCurve::sine ? shape.fringe / 2 : 0;
    for (const double edge : {-shape.half_length, shape.half_length}) {
      plane(2, edge - beside);
      if (beside > 0) plane(2, edge + beside);
    }
  }
  if (term.kind == ShapedKind::flat_sheet) plane(1, 0);
  if (term.kind == ShapedKind::sheet) cylinder(term.sheet.radius);
  if (term.kind == ShapedKind::wire) cylinder(term.wire.radius);
  return latest;
}

/// Adds one term's field at (x, y, z) of the laboratory. A function of its own for each number type, as it
/// holds the formulas of all kinds.
template <class Maths, class Number>
[[gnu::noinline]] void add_field(const ShapedTerm& term, const Number& x, const Number& y, const Number& z,
                                 FieldHere<Number>& sum) {
  const double* axes = term.axes;
  Number own[3];
  own_place(term, x, y, z, own);
  const FieldHere<Number> here =
      with_shape(term, [&](const auto& shape) { return field_of<Maths>(shape, own[0], own[1], own[2]); });
  if (!term.turned) {
    for (int i = 0; i < 3; ++i) sum.field[i] = sum.field[i] + here.field[i];
    for (int i = 0; i < 9; ++i) sum.slope[i] = sum.slope[i] + here.slope[i];
    return;
  }
  // A^T B and A^T G A, the rows of A being the axes.
  Number half[9];
  for (int i = 0; i < 3; ++i)
    for (int b = 0; b < 3; ++b)
      half[3 * i + b] =
          here.slope[b] * axes[i] + here.slope[3 + b] * axes[3 + i] + here.slope[6 + b] * axes[6 + i];
  for (int i = 0; i < 3; ++i) {
    sum.field[i] =
        sum.field[i] + (here.field[0] * axes[i] + here.field[1] * axes[3 + i] + here.field[2] * axes[6 + i]);
    for (int k = 0; k < 3; ++k)
      sum.slope[3 * i + k] = sum.slope[3 * i + k] + (half[3 * i] * axes[k] + half[3 * i + 1] * axes[3 + k] +
                                                     half[3 * i + 2] * axes[6 + k]);
  }
}

/// The same of a field that stands or follows a course, at a time.
template <class Maths, class Number>
void add_field_at(const ShapedTerm& term, const Number& x, const Number& y, const Number& z, const Number& t,
                  FieldHere<Number>& sum) {
  if (term.course.nodes == 0) return add_field<Maths>(term, x, y, z, sum);
  FieldHere<Number> peak{};
  add_field<Maths>(term, x, y, z, peak);
  const Number share = course_at<Maths>(term.course, t).share;
  for (int k = 0; k < 3; ++k) sum.field[k] = sum.field[k] + share * peak.field[k];
  for (int k = 0; k < 9; ++k) sum.slope[k] = sum.slope[k] + share * peak.slope[k];
}

}  // namespace rabiline
