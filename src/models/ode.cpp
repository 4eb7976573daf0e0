#include "models/ode.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <memory>
#include <stdexcept>

namespace rabiline {
namespace {

struct Problem {
  const Derivative& derivative;
  std::size_t size;
};

int call(double t, const double y[], double dydt[], void* problem) {
  const Problem& p = *static_cast<Problem*>(problem);
  p.derivative(t, {y, p.size}, {dydt, p.size});
  return GSL_SUCCESS;
}

struct Free {
  void operator()(gsl_odeiv2_driver* driver) const { gsl_odeiv2_driver_free(driver); }
};

}  // namespace

std::vector<std::vector<double>> integrate(const Derivative& derivative, std::vector<double> start,
                                           std::span<const double> times, double tolerance) {
  gsl_set_error_handler_off();
  Problem problem{derivative, start.size()};
  gsl_odeiv2_system system{call, nullptr, start.size(), &problem};
  const double first_step = times.size() > 1 ? 1e-3 * (times[1] - times[0]) : 1;
  const std::unique_ptr<gsl_odeiv2_driver, Free> driver(
      gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, first_step, tolerance, tolerance));
  if (!driver) throw std::bad_alloc();
  std::vector<std::vector<double>> rows{start};
  double now = times.front();
  for (const double time : times.subspan(1)) {
    if (gsl_odeiv2_driver_apply(driver.get(), &now, time, start.data()) != GSL_SUCCESS)
      throw std::runtime_error("the motion could not be integrated: steps became too short");
    rows.push_back(start);
  }
  return rows;
}

}  // namespace rabiline
