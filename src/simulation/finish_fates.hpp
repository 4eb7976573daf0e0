#pragma once
// What became of every particle, from exact sums to the ledger.
#include "simulation/finish.hpp"

namespace rabiline {

/// Adds the fates, of all particles and by the level in which they were prepared. Throws std::logic_error
/// unless they add up to what was emitted, in quanta.
void finish_fates(const Summed&, Result&);

}  // namespace rabiline
