#pragma once
// An independent integration of a spin in any field B(t): GSL's Runge-Kutta-Prince-Dormand 8(7), no code
// shared with the program. dS/dt = gamma S x B.
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <functional>

#include "physics/independent.hpp"

namespace rabiline::test {

using FieldInTime = std::function<Vec(double t)>;

struct SpinProblem {
  double gamma;
  const FieldInTime& field;
};

inline int spin_derivative(double t, const double y[], double f[], void* parameters) {
  const SpinProblem& p = *static_cast<SpinProblem*>(parameters);
  const Vec ds = cross({y[0], y[1], y[2]}, p.field(t));
  for (std::size_t i = 0; i < 3; ++i) f[i] = p.gamma * ds[i];
  return GSL_SUCCESS;
}

inline Vec spin_after(double gamma, const FieldInTime& b, double from, double to, Vec s) {
  SpinProblem problem{gamma, b};
  gsl_odeiv2_system system{spin_derivative, nullptr, 3, &problem};
  gsl_odeiv2_driver* driver =
      gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 1e-8, 1e-12, 1e-12);
  double t = from;
  gsl_odeiv2_driver_apply(driver, &t, to, s.data());
  gsl_odeiv2_driver_free(driver);
  return s;
}

}  // namespace rabiline::test
