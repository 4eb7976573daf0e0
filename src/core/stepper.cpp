#include "core/stepper.hpp"

#include <gsl/gsl_errno.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "core/portable_math.hpp"

namespace rabiline {

Stepper::Stepper(std::size_t count, double error, double length) : error_(error), length_(length) {
  gsl_set_error_handler_off();  // it ends the program
  step_.reset(gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, count));
  evolve_.reset(gsl_odeiv2_evolve_alloc(count));
  if (!step_ || !evolve_) throw std::bad_alloc();
}

Stepper::Stepper(std::span<const double> sizes, double error, double length)
    : Stepper(sizes.size(), error, length) {
  sizes_ = sizes;
}

int Stepper::go(gsl_odeiv2_system& system, double& t, double end, double longest, double* state) {
  const gsl_odeiv2_control_type by_error{"by error", nullptr, nullptr, adjust, nullptr, nullptr, nullptr};
  gsl_odeiv2_control control{&by_error, this};
  while (t < end) {
    length_ = std::min(length_, longest);
    const int status =
        gsl_odeiv2_evolve_apply(evolve_.get(), &control, step_.get(), &system, &t, end, &length_, state);
    if (status != GSL_SUCCESS) return status;
  }
  return GSL_SUCCESS;
}

/// As gsl_odeiv2_control_y_new and gsl_odeiv2_control_scaled_new choose it.
int Stepper::adjust(void* stepper, std::size_t count, unsigned order, const double y[], const double error[],
                    const double*, double* step) {
  const Stepper& own = *static_cast<Stepper*>(stepper);
  double worst = 0;  // error over the one allowed
  for (std::size_t i = 0; i < count; ++i)
    worst = std::max(
        worst, std::abs(error[i]) / (own.error_ * (own.sizes_.empty() ? 1 + std::abs(y[i]) : own.sizes_[i])));
  constexpr double safety = 0.9;
  if (worst > 1.1) {
    *step *= std::max(0.2, safety / portable::pow(worst, 1.0 / order));
    return GSL_ODEIV_HADJ_DEC;
  }
  if (worst >= 0.5) return GSL_ODEIV_HADJ_NIL;
  *step *= std::clamp(safety / portable::pow(std::max(worst, 1e-30), 1.0 / (order + 1.0)), 1.0, 5.0);
  return GSL_ODEIV_HADJ_INC;
}

}  // namespace rabiline
