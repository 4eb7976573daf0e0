#include "models/times.hpp"

#include <algorithm>
#include <cmath>

namespace rabiline {

Times times_of(double duration, double turns, std::uint64_t samples) {
  const std::uint64_t gaps = samples - 1;
  Times out;
  out.stride = static_cast<std::size_t>(std::max(1.0, std::ceil(16 * turns / static_cast<double>(gaps))));
  const std::size_t steps = out.stride * gaps;
  out.all.reserve(steps + 1);
  for (std::size_t i = 0; i <= steps; ++i)
    out.all.push_back(duration * (static_cast<double>(i) / static_cast<double>(steps)));
  return out;
}

}  // namespace rabiline
