#include "models/ode.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "core/portable_math.hpp"

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

/// The next step: as gsl_odeiv2_control_y_new chooses it, but with a power that has the same bits on every
/// processor. `tolerance` is the control's whole state.
int adjust_step(void* tolerance, std::size_t size, unsigned order, const double y[], const double error[],
                const double[], double* step) {
  double worst = 0;  // error over the one allowed
  for (std::size_t i = 0; i < size; ++i)
    worst = std::max(worst, std::abs(error[i]) / (*static_cast<double*>(tolerance) * (1 + std::abs(y[i]))));
  constexpr double safety = 0.9;
  if (worst > 1.1) {
    *step *= std::max(0.2, safety / portable::pow(worst, 1.0 / order));
    return GSL_ODEIV_HADJ_DEC;
  }
  if (worst >= 0.5) return GSL_ODEIV_HADJ_NIL;
  worst = std::max(worst, 1e-30);
  *step *= std::clamp(safety / portable::pow(worst, 1.0 / (order + 1.0)), 1.0, 5.0);
  return GSL_ODEIV_HADJ_INC;
}

struct Free {
  void operator()(gsl_odeiv2_step* step) const { gsl_odeiv2_step_free(step); }
  void operator()(gsl_odeiv2_evolve* evolve) const { gsl_odeiv2_evolve_free(evolve); }
};

}  // namespace

std::vector<std::vector<double>> integrate(const Derivative& derivative, std::vector<double> start,
                                           std::span<const double> times, double tolerance) {
  gsl_set_error_handler_off();
  Problem problem{derivative, start.size()};
  gsl_odeiv2_system system{call, nullptr, start.size(), &problem};
  const std::unique_ptr<gsl_odeiv2_step, Free> step(
      gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, start.size()));
  const std::unique_ptr<gsl_odeiv2_evolve, Free> evolve(gsl_odeiv2_evolve_alloc(start.size()));
  if (!step || !evolve) throw std::bad_alloc();
  const gsl_odeiv2_control_type by_error{"by error", nullptr, nullptr, adjust_step,
                                         nullptr,    nullptr, nullptr};
  gsl_odeiv2_control control{&by_error, &tolerance};
  std::vector<std::vector<double>> rows{start};
  double now = times.front(), length = times.size() > 1 ? 1e-3 * (times[1] - times[0]) : 1;
  for (const double time : times.subspan(1)) {
    while (now < time)
      if (gsl_odeiv2_evolve_apply(evolve.get(), &control, step.get(), &system, &now, time, &length,
                                  start.data()) != GSL_SUCCESS)
        throw std::runtime_error("the motion could not be integrated: steps became too short");
    rows.push_back(start);
  }
  return rows;
}

}  // namespace rabiline
