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

/// Weight: what flies free of everything else falls along a parabola; along the beam its speed changes.
struct Gravity {
  double acceleration = 0;         // [m/s^2]
  UnitVector direction{0, 0, -1};  // downwards
  bool operator==(const Gravity&) const = default;
};
template <>
inline constexpr auto parameters<Gravity> = std::tuple{
    param("acceleration", &Gravity::acceleration, Dimension::acceleration, range::not_negative,
          "how fast the speed of a free fall grows"),
    param("direction", &Gravity::direction, "where it falls to; down, -z, if omitted", UnitVector{0, 0, -1}),
};
template <>
inline constexpr std::string_view short_key<Gravity> = "acceleration";

/// In the unit of what is scanned.
struct ScannedQuantity {
  double value = 0;  // [SI]
  Dimension dimension = Dimension::number;
  bool operator==(const ScannedQuantity&) const = default;
};
/// A precision that is enough, whatever the number of particles; all that is asked for.
struct Until {
  std::optional<double> detected_error;         // [1] of each detector at each scan point
  std::optional<ScannedQuantity> centre_error;  // of the place of the line along the scan
  bool operator==(const Until&) const = default;
};
template <>
inline constexpr auto parameters<Until> = std::tuple{
    param("detected_error", &Until::detected_error, Dimension::number,
          {0, 1, false, false, "greater than 0 and less than 1"},
          "standard error of `detected`, a part of the emitted particles, at every detector and scan point"),
    param("centre_error", &Until::centre_error, Dimension::number, range::positive,
          "standard error of the place of the whole line in `detected` along the scan, at the detector that "
          "tells it best"),
};

struct Beamline {
  std::string title;
  std::vector<Component> species;  // fractions add up to 1
  Law law;
  Source source;
  std::optional<Chamber> chamber;  // no wall where it is missing
  std::optional<Gravity> gravity;  // nothing falls where it is missing
  std::vector<PlacedPart> parts;   // in order of `at`
  std::uint64_t particles = 0;     // per scan point, at most where there is an `until`
  std::optional<Until> until;
  std::uint64_t seed = 0;
  bool operator==(const Beamline&) const = default;
};

}  // namespace rabiline
