#pragma once
// What every field must keep to, by numeric differentiation.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/vector3.hpp"
#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"

namespace rabiline::test {

using Here = FieldHere<double>;

inline Here field_at(const ShapedTerm& term, const Vector3& r) {
  Here sum{};
  add_field<HostMaths>(term, r.x, r.y, r.z, sum);
  return sum;
}

/// The term somewhere, its axes turned by three angles.
inline ShapedTerm turned_elsewhere(ShapedTerm term) {
  const Vector3 axes[] = {turned({1, 0, 0}, 0.3, -0.5, 0.7), turned({0, 1, 0}, 0.3, -0.5, 0.7),
                          turned({0, 0, 1}, 0.3, -0.5, 0.7)};
  int i = 0;
  for (const Vector3& axis : axes)
    for (const double component : {axis.x, axis.y, axis.z}) term.axes[i++] = component;
  term.turned = true;
  term.x = 0.01;
  term.y = 0.2;
  term.z = -0.02;
  return term;
}

/// Where a place of the term's own frame is in the laboratory.
inline Vector3 in_laboratory(const ShapedTerm& term, const Vector3& own) {
  const double r[3] = {own.x, own.y, own.z};
  Vector3 out{term.x, term.y, term.z};
  for (int a = 0; a < 3; ++a)
    out = out + r[a] * Vector3{term.axes[3 * a], term.axes[3 * a + 1], term.axes[3 * a + 2]};
  return out;
}

inline double largest(const double (&slope)[9]) {
  double most = 0;
  for (const double s : slope) most = std::max(most, std::abs(s));
  return most;
}
inline double divergence(const Here& f) { return f.slope[0] + f.slope[4] + f.slope[8]; }
inline double curl(const Here& f) {
  return std::max({std::abs(f.slope[1] - f.slope[3]), std::abs(f.slope[2] - f.slope[6]),
                   std::abs(f.slope[5] - f.slope[7])});
}

/// The largest deviation of the nine slopes from differences of B, fourth order in h.
inline double slope_error(const ShapedTerm& term, const Vector3& r, double h) {
  const Here here = field_at(term, r);
  const Vector3 steps[] = {{h, 0, 0}, {0, h, 0}, {0, 0, h}};
  double worst = 0;
  for (int k = 0; k < 3; ++k) {
    const Here a = field_at(term, r + steps[k]), b = field_at(term, r - steps[k]);
    const Here c = field_at(term, r + 2.0 * steps[k]), d = field_at(term, r - 2.0 * steps[k]);
    for (int i = 0; i < 3; ++i) {
      const double slope = (8 * (a.field[i] - b.field[i]) - (c.field[i] - d.field[i])) / (12 * h);
      worst = std::max(worst, std::abs(slope - here.slope[3 * i + k]));
    }
  }
  return worst;
}

}  // namespace rabiline::test
