#pragma once
// The times that a model is solved at.
#include <cstdint>
#include <vector>

#include "parameter/parameter.hpp"

namespace rabiline {

/// How many times can be written.
inline constexpr Range range_of_samples{2, 1e6, true, true, "from 2 to 1000000"};

/// Times that are computed, from 0 on and evenly spaced; every `stride`-th is written.
struct Times {
  std::vector<double> all{};  // [s]
  std::size_t stride = 1;
};

/// At least `samples` times, and 16 for each of the turns that are followed from one time to the next.
Times times_of(double duration, double turns, std::uint64_t samples);

}  // namespace rabiline
