#pragma once
// Ordinary differential equations in steps of their own length, by GSL.
#include <memory>
#include <span>

#include <gsl/gsl_odeiv2.h>

namespace rabiline {

/// Runge-Kutta steps of Prince and Dormand, 8(7) (GSL's rk8pd), whose length GSL's rule chooses by a power
/// that has the same bits on every processor. GSL's own driver ends the program where there is no memory for
/// it; here std::bad_alloc is thrown.
class Stepper {
 public:
  /// Each step may be off by `error` of 1 and of each of the `count` numbers; `length` is that of the first
  /// one.
  Stepper(std::size_t count, double error, double length);
  /// By `error` of a size of each number instead, which must outlive it.
  Stepper(std::span<const double> sizes, double error, double length);
  /// Takes a state from t to `end` in steps that are no longer than `longest`; a status of GSL.
  int go(gsl_odeiv2_system&, double& t, double end, double longest, double* state);

 private:
  struct Free {
    void operator()(gsl_odeiv2_step* step) const { gsl_odeiv2_step_free(step); }
    void operator()(gsl_odeiv2_evolve* evolve) const { gsl_odeiv2_evolve_free(evolve); }
  };
  static int adjust(void* stepper, std::size_t count, unsigned order, const double y[], const double error[],
                    const double slope[], double* step);

  std::span<const double> sizes_{};  // none: 1 and the number itself
  const double error_;
  double length_;
  std::unique_ptr<gsl_odeiv2_step, Free> step_;
  std::unique_ptr<gsl_odeiv2_evolve, Free> evolve_;
};

}  // namespace rabiline
