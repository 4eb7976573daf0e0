#pragma once
// Plain, because kernels of every instruction set read it.

namespace rabiline {

/// Moments of levels against the size of the field, as MomentTable has them (spin/moment_table.hpp). Compared
/// by address: a plan makes each table once.
struct MomentLaw {
  const double* coefficients = nullptr;  // [level][cell][power] J/T; null: one constant moment
  int cells = 1;
  double scale = 1;  // [T]
  bool operator==(const MomentLaw&) const = default;
};

}  // namespace rabiline
