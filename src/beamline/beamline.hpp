#pragma once
// A whole experiment at one point of its scan, as plain values: what the file says, read and checked.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "beamline/law.hpp"
#include "particle/source.hpp"
#include "particle/species.hpp"
#include "parts/part.hpp"

namespace rabiline {

/// The vacuum chamber: a round wall along the whole beam.
struct Chamber {
  double radius = 0;  // [m]
  bool operator==(const Chamber&) const = default;
};
template <>
inline constexpr auto parameters<Chamber> = std::tuple{
    param("radius", &Chamber::radius, Dimension::length, range::positive,
          "radius of the wall around the axis"),
};

struct Beamline {
  std::string title;
  std::vector<Component> species;  // fractions add up to 1
  Law law;
  Source source;
  std::optional<Chamber> chamber;  // no wall where it is missing
  std::vector<PlacedPart> parts;   // in order of `at`
  std::uint64_t particles = 0;     // per scan point
  std::uint64_t seed = 0;
  bool operator==(const Beamline&) const = default;
};

}  // namespace rabiline
