#pragma once
// An independent integration of the hypothesis in the laboratory frame: GSL's Runge-Kutta-Prince-Dormand
// 8(7), no code shared with the program. dS/dt = w x S, dv/dt = kappa W x v, dr/dt = v, w = -gamma B.
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <array>
#include <cmath>

namespace rabiline::test {

using Vec = std::array<double, 3>;

inline Vec cross(const Vec& a, const Vec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Where the field is B + H0 (cos, sin)(omega t + phase), everywhere.
struct Hypothesis {
  double gamma, b, h0, omega, phase, kappa;
  bool torque;
};

struct Motion {
  double t;
  Vec r, v, s;
};

inline int derivative(double t, const double y[], double f[], void* parameters) {
  const Hypothesis& p = *static_cast<Hypothesis*>(parameters);
  const double angle = p.omega * t + p.phase;
  const Vec w{-p.gamma * p.h0 * std::cos(angle), -p.gamma * p.h0 * std::sin(angle), -p.gamma * p.b};
  const Vec v{y[3], y[4], y[5]}, s{y[6], y[7], y[8]};
  Vec turning = w;
  if (p.torque) {
    const double along = w[0] * s[0] + w[1] * s[1] + w[2] * s[2];
    for (std::size_t i = 0; i < 3; ++i) turning[i] -= along * s[i];
  }
  const Vec dv = cross(turning, v), ds = cross(w, s);
  for (std::size_t i = 0; i < 3; ++i) {
    f[i] = v[i];
    f[3 + i] = p.kappa * dv[i];
    f[6 + i] = ds[i];
  }
  return GSL_SUCCESS;
}

/// Integrates from one time to another.
class Integrator {
 public:
  explicit Integrator(Hypothesis hypothesis, double tolerance = 1e-11)
      : hypothesis_(hypothesis), system_{derivative, nullptr, 9, &hypothesis_} {
    driver_ = gsl_odeiv2_driver_alloc_y_new(&system_, gsl_odeiv2_step_rk8pd, 1e-8, tolerance, tolerance);
  }
  ~Integrator() { gsl_odeiv2_driver_free(driver_); }
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  Motion to(double t, const Motion& from) {
    double y[9] = {from.r[0], from.r[1], from.r[2], from.v[0], from.v[1],
                   from.v[2], from.s[0], from.s[1], from.s[2]};
    double now = from.t;
    gsl_odeiv2_driver_reset(driver_);
    if (t > now) gsl_odeiv2_driver_apply(driver_, &now, t, y);
    return {t, {y[0], y[1], y[2]}, {y[3], y[4], y[5]}, {y[6], y[7], y[8]}};
  }
  /// To the plane y = `plane`, where the flight goes forward.
  Motion to_plane(double plane, const Motion& from) {
    Motion m = to(from.t + 0.98 * (plane - from.r[1]) / from.v[1], from);
    for (int i = 0; i < 40 && std::abs(plane - m.r[1]) > 1e-13; ++i) {
      const double t = m.t + (plane - m.r[1]) / m.v[1];
      m = to(t, t > m.t ? m : from);
    }
    return m;
  }

 private:
  Hypothesis hypothesis_;
  gsl_odeiv2_system system_;
  gsl_odeiv2_driver* driver_ = nullptr;
};

}  // namespace rabiline::test
