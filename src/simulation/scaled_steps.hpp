#pragma once
// An independent integrator, for checks.
#include <memory>
#include <span>

#include <gsl/gsl_odeiv2.h>

namespace rabiline {

/// GSL's Runge-Kutta steps of eighth order (rk8pd), whose error is held against a size of each number. GSL's
/// own driver ends the program where there is no memory for it; here std::bad_alloc is thrown.
class ScaledSteps {
 public:
  /// `error` of each number over its size, which must outlive it, for each step; `length` of the first one.
  ScaledSteps(std::span<const double> sizes, double error, double length);
  /// Takes a state from t to `end` in steps that are no longer than `longest`; a status of GSL.
  int go(gsl_odeiv2_system&, double& t, double end, double longest, double* state);

 private:
  struct Free {
    void operator()(gsl_odeiv2_step* step) const { gsl_odeiv2_step_free(step); }
    void operator()(gsl_odeiv2_evolve* evolve) const { gsl_odeiv2_evolve_free(evolve); }
  };
  static int adjust(void* steps, std::size_t size, unsigned order, const double y[], const double error[],
                    const double slope[], double* step);

  const std::span<const double> sizes_;
  const double error_;
  double length_;
  std::unique_ptr<gsl_odeiv2_step, Free> step_;
  std::unique_ptr<gsl_odeiv2_evolve, Free> evolve_;
};

}  // namespace rabiline
