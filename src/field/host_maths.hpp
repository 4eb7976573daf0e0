#pragma once
// What formulas of fields need beyond + - * / of plain numbers, on the host: the kernels' own functions one
// lane wide, so that host and kernels agree to the bit. field/lane_maths.hpp is its twin for vectors.
#include <cmath>

#include "core/portable_math.hpp"

namespace rabiline {

struct HostMaths {
  static constexpr int lanes = 1;
  static double root(double x) { return std::sqrt(x); }
  static double floor(double x) { return std::floor(x); }
  static double exponential(double x) { return portable::exp(x < -700 ? -700 : x > 700 ? 700 : x); }
  static double logarithm(double x) { return portable::log(x); }
  static double arctangent(double x) { return portable::atan(x); }
  static void sine_and_cosine(double x, double& sine, double& cosine) {
    sine = portable::sin(x);
    cosine = portable::cos(x);
  }
  static double select(bool condition, double yes, double no) { return condition ? yes : no; }
  static double load(const double* p) { return *p; }
  static void store(double* p, double x) { *p = x; }
};

}  // namespace rabiline
