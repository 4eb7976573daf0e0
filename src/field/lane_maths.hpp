#pragma once
// What formulas of fields need beyond + - * / of vectors of numbers, once for each instruction set.
#include "core/lanes.hpp"

namespace rabiline::RABILINE_ISA {

struct LaneMaths {
  static constexpr int lanes = lane_count;
  RABILINE_LANES static real root(real x) { return RABILINE_ISA::sqrt(x); }
  RABILINE_LANES static real floor(real x) { return RABILINE_ISA::floor(x); }
  RABILINE_LANES static real exponential(real x) { return RABILINE_ISA::exp(x); }
  RABILINE_LANES static real logarithm(real x) { return RABILINE_ISA::log(x); }
  RABILINE_LANES static real arctangent(real x) { return RABILINE_ISA::atan(x); }
  RABILINE_LANES static void sine_and_cosine(real x, real& sine, real& cosine) {
    RABILINE_ISA::sincos(x, sine, cosine);
  }
  RABILINE_LANES static real select(mask condition, real yes, real no) {
    return RABILINE_ISA::select(condition, yes, no);
  }
  RABILINE_LANES static real load(const double* p) { return RABILINE_ISA::load(p); }
  RABILINE_LANES static void store(double* p, real x) { RABILINE_ISA::store(p, x); }
};

}  // namespace rabiline::RABILINE_ISA
