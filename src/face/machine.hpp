#pragma once
// What a run takes of the machine.
#include "rabiline.hpp"

namespace rabiline {

/// Both throw std::invalid_argument where there is no such number.
int threads_of(const RunSettings&);
int batch_of(const RunSettings&);

}  // namespace rabiline
