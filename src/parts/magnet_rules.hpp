#pragma once
// What deflecting magnets must leave free.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <string_view>
#include <variant>
#include <vector>

#include "core/portable_math.hpp"
#include "parts/placement.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

/// Poles that do not alternate.
inline std::vector<Fault> faults_of_poles(std::uint64_t poles, const Placement& place) {
  if (poles % 2 == 0) return {};
  return {{place.name, "poles",
           fmt::format("`{}` cannot have {} poles: north and south alternate", place.name, poles),
           "write an even number: 4 for a quadrupole, 6 for a sextupole"}};
}

/// A magnet whose walls stand on the beam's axis; `key` is what moves them.
template <class Magnet>
std::vector<Fault> faults_of_axis(const Magnet& part, const Placement& place, std::string_view walls,
                                  std::string_view key) {
  SectionBuilder builder(Wall{});
  Magnet bare = part;
  if constexpr (requires { bare.fringe; }) bare.fringe = {};
  contribute(bare, place, builder);
  const auto magnet = std::get<MagnetTerm>(builder.build().planes.front().term);
  const double c = portable::cos(magnet.tilt.y), s = portable::sin(magnet.tilt.y);
  const Offset o = magnet.offset;
  if (is_free<bool>(magnet.walls, s * o.z - c * o.x, magnet.shape.height - s * o.x - c * o.z)) return {};
  const bool centred = o == Offset{};
  return {{place.name, centred ? std::string(key) : "offset",
           fmt::format("the beam's axis meets the {} of `{}`", walls, place.name),
           centred ? fmt::format("change `{}`, or make room for the beam", key) : "make its offset smaller"}};
}

}  // namespace rabiline
