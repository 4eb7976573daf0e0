#pragma once
#include "parts/coil_strength.hpp"
#include "parts/placement.hpp"
#include "parts/time_factor.hpp"

namespace rabiline {

class SectionBuilder;

struct CoilGradient {
  static constexpr std::string_view kind = "gradient", meaning = "the gradient in the middle";
  double gradient = 0;  // [T/m]
  bool operator==(const CoilGradient&) const = default;
};
template <>
inline constexpr auto parameters<CoilGradient> = std::tuple{
    param("gradient", &CoilGradient::gradient, Dimension::field_gradient, range::any,
          "in the middle, of the field along the direction along itself; the currents are then opposed"),
};
using PairStrength = std::variant<CoilCurrent, CoilField, CoilGradient>;
template <>
inline constexpr std::string_view tag_key<PairStrength> = "";  // told apart by their keys
template <>
inline constexpr std::string_view said_by_keys<PairStrength> = "its strength";

/// Two rings of current on one axis, their middle at `at`: as far apart as their radius they are Helmholtz's,
/// of an even field; with opposed currents the field is zero in the middle and grows evenly.
struct CoilPair {
  static constexpr std::string_view kind = "coil_pair",
                                    meaning =
                                        "the field of two rings of current on one axis, their middle at `at`";
  static constexpr std::string_view place = "the middle between the two rings, from the source";
  static constexpr PartTraits traits{.field = true};
  static constexpr std::string_view example = "radius: 10 cm, current: 2 A, turns: 50";
  double radius = 0;                 // [m]
  std::optional<double> distance{};  // [m]
  PairStrength strength;
  bool opposed = false;
  UnitVector direction{};
  std::optional<double> reach{};  // [m]
  Offset offset{};
  Tilt tilt{};
  std::optional<TimeFactor> oscillates{};
  bool operator==(const CoilPair&) const = default;
};
template <>
inline constexpr auto parameters<CoilPair> = std::tuple{
    param("radius", &CoilPair::radius, Dimension::length, range::positive, "of the rings"),
    param("distance", &CoilPair::distance, Dimension::length, range::positive,
          "from one ring to the other; the radius if omitted: Helmholtz's pair"),
    param("", &CoilPair::strength, "the current in each ring, or the field or gradient in the middle"),
    param("opposed", &CoilPair::opposed,
          "true: the current of the ring on the side that the direction points away from is reversed", false),
    param("direction", &CoilPair::direction, "of the axis; z if omitted", UnitVector{}),
    param("reach", &CoilPair::reach, Dimension::length, range::positive,
          "how far from the middle the field is taken on both sides; if omitted, up to 1e-4 of its "
          "largest"),
    param("offset", &CoilPair::offset, "displacement of the middle from the axis", Offset{}),
    param("tilt", &CoilPair::tilt, "how the pair is turned about its middle", Tilt{}),
    param("oscillates", &CoilPair::oscillates,
          "frequency and phase with which the whole field swings; it stands if omitted"),
};

void contribute(const CoilPair&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const CoilPair&, const Placement&);

}  // namespace rabiline
