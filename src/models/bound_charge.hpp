#pragma once
// The Larmor effect, eqs. 73-75 of M. Dorado, "Equations of Motion of Systems with Internal Angular Momentum
// - II": a charge bound to a fixed centre in a uniform magnetic field along z. Slow charges; no radiation.
//
// Eq. 74 takes r x (m v x W) for (r x m v) x W with W = q B/m. The two differ by m r (v.W) - m W (r.v), so
// that they agree only where r.v = v.W = 0: on a circle across the field, where L is along W and nothing
// precesses. On an inclined circle the mean of the first over an orbit is half of the second: L turns with
// Larmor's q B/2m.
#include <cstdint>
#include <numbers>
#include <variant>
#include <vector>

#include "models/motion.hpp"
#include "models/times.hpp"
#include "particle/species.hpp"

namespace rabiline {

struct HarmonicBinding {
  static constexpr std::string_view kind = "harmonic",
                                    meaning = "a force towards the centre that grows with the distance";
  double frequency = 0;  // [Hz]
  double radius = 0;     // [m]
  bool operator==(const HarmonicBinding&) const = default;
};
template <>
inline constexpr auto parameters<HarmonicBinding> = std::tuple{
    param("frequency", &HarmonicBinding::frequency, Dimension::frequency, range::positive,
          "orbits per second without the field"),
    param("radius", &HarmonicBinding::radius, Dimension::length, range::positive,
          "of the circle without the field"),
};

struct CoulombBinding {
  static constexpr std::string_view kind = "coulomb", meaning = "the force of a fixed charge at the centre";
  double charge = 0;  // [C]
  double radius = 0;  // [m]
  bool operator==(const CoulombBinding&) const = default;
};
template <>
inline constexpr auto parameters<CoulombBinding> = std::tuple{
    param("charge", &CoulombBinding::charge, Dimension::charge, range::any,
          "charge at the centre: q' of the paper, of the other sign"),
    param("radius", &CoulombBinding::radius, Dimension::length, range::positive,
          "of the circle without the field"),
};

struct NoBinding {
  static constexpr std::string_view kind = "free", meaning = "nothing binds it: the cyclotron's orbit";
  double speed = 0;  // [m/s]
  bool operator==(const NoBinding&) const = default;
};
template <>
inline constexpr auto parameters<NoBinding> = std::tuple{
    param("speed", &NoBinding::speed, Dimension::speed, range::positive, "speed at the start"),
};

using Binding = std::variant<HarmonicBinding, CoulombBinding, NoBinding>;

struct BoundCharge {
  static constexpr std::string_view kind = "bound_charge",
                                    meaning =
                                        "a charge bound to a centre in a uniform field: the Larmor effect";
  /// Keys that go together, for help.
  static constexpr std::string_view example =
      "species: electron, field: 10 mT, binding: {kind: coulomb, charge: 1 e, radius: 100 nm}, "
      "inclination: 40 deg, orbits: 100, samples: 2001";
  std::vector<Component> species{};  // one
  double field = 0;                  // [T] along z
  Binding binding{};
  double inclination = 0;     // [rad]
  double orbits = 0;          // without the field; of a free charge, turns in it
  std::uint64_t samples = 0;  // times that are written, both ends included
  bool operator==(const BoundCharge&) const = default;
};
template <>
inline constexpr auto parameters<BoundCharge> = std::tuple{
    param("species", &BoundCharge::species, "the charge: of the library or one's own"),
    param("field", &BoundCharge::field, Dimension::magnetic_field, range::any, "uniform field along z"),
    param("binding", &BoundCharge::binding, "what holds it"),
    param("inclination", &BoundCharge::inclination, Dimension::angle,
          Range{0, std::numbers::pi, true, true, "between 0 and 180 deg"},
          "angle between the orbit's axis and +z at the start; the charge starts at +x"),
    param("orbits", &BoundCharge::orbits, Dimension::number,
          Range{0.01, range::infinite, true, true, "0.01 or more"},
          "how long it is followed, in orbits without the field; of a free charge, in turns in the field"),
    param("samples", &BoundCharge::samples, Dimension::number, range_of_samples,
          "times that are written, both ends included"),
};

/// Motions `standard` and, of a bound charge, `larmor_theorem` and `eq74`.
ModelResult solve(const BoundCharge&);
std::vector<Fact> facts_of(const BoundCharge&);
std::vector<Fault> faults_of(const BoundCharge&);

}  // namespace rabiline
