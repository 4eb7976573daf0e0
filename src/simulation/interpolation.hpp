#pragma once
// From few frequencies to what each scan point counts.
#include "plan/plan.hpp"

namespace rabiline {

/// Adds to the sums of every reweighting what follows from frequency nodes; `threads` as for in_parallel().
/// Fates, and the ledger of each prepared level, still add up to the quantum. Throws std::logic_error where
/// more than rounding is between.
void interpolate(const Plan&, int threads, Sums&);

}  // namespace rabiline
