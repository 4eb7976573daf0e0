#pragma once
// Several walls along one stretch of the beam.
#include "transport/kernels.hpp"

namespace rabiline {

/// By their openings, as a kernel sees them.
struct WallRow {
  const Aperture* walls = nullptr;
  int count = 0;
};

}  // namespace rabiline
