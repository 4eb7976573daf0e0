#include "models/ode.hpp"

#include <gsl/gsl_errno.h>

#include <limits>
#include <stdexcept>

#include "core/stepper.hpp"

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

}  // namespace

std::vector<std::vector<double>> integrate(const Derivative& derivative, std::vector<double> start,
                                           std::span<const double> times, double tolerance) {
  Problem problem{derivative, start.size()};
  gsl_odeiv2_system system{call, nullptr, start.size(), &problem};
  Stepper stepper(start.size(), tolerance, times.size() > 1 ? 1e-3 * (times[1] - times[0]) : 1);
  std::vector<std::vector<double>> rows{start};
  double now = times.front();
  for (const double time : times.subspan(1)) {
    if (stepper.go(system, now, time, std::numeric_limits<double>::infinity(), start.data()) != GSL_SUCCESS)
      throw std::runtime_error("the motion could not be integrated: steps became too short");
    rows.push_back(start);
  }
  return rows;
}

}  // namespace rabiline
