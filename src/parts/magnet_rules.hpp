#pragma once
// What deflecting magnets must leave free.
#include <fmt/format.h>

#include <cstdint>
#include <vector>

#include "parts/placement.hpp"

namespace rabiline {

/// Poles that do not alternate.
inline std::vector<Fault> faults_of_poles(std::uint64_t poles, const Placement& place) {
  if (poles % 2 == 0) return {};
  return {{place.name, "poles",
           fmt::format("`{}` cannot have {} poles: north and south alternate", place.name, poles),
           "write an even number: 4 for a quadrupole, 6 for a sextupole"}};
}

}  // namespace rabiline
