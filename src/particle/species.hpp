#pragma once
// What flies: mass, charge, spin and one gyromagnetic ratio.
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>

#include "parameter/parameter.hpp"

namespace rabiline {

/// A spin quantum number, kept as twice its value so that 3/2 is exact.
struct HalfInteger {
  int twice = 0;
  double value() const { return twice / 2.0; }
  bool operator==(const HalfInteger&) const = default;
};

/// A species with one moment, mu = gamma S, with signed gamma. Uncertainties are standard ones; 0 is none
/// stated.
struct Species {
  std::string name;
  double mass = 0;                            // [kg]
  double charge = 0;                          // [C]
  HalfInteger spin;                           // I, in units of hbar
  double gyromagnetic_ratio = 0;              // [rad/(s T)] signed: mu = gamma S
  std::string source;                         // where the constants come from
  std::string left_out{};                     // what the moment does not have in it
  double mass_uncertainty = 0;                // [kg]
  double gyromagnetic_ratio_uncertainty = 0;  // [rad/(s T)]
  bool operator==(const Species&) const = default;
};

template <>
inline constexpr auto parameters<Species> = std::tuple{
    param("name", &Species::name, "what the species is called in messages and results"),
    param("mass", &Species::mass, Dimension::mass, range::positive, "mass, e.g. 7.016 u"),
    param("charge", &Species::charge, Dimension::charge, range::any, "charge, e.g. 0 e or 1 e"),
    param("spin", &Species::spin, "spin quantum number, 1/2 to 9/2, e.g. 3/2"),
    param("gyromagnetic_ratio", &Species::gyromagnetic_ratio, Dimension::gyromagnetic, range::any,
          "signed gamma in mu = gamma S: 16.5 MHz/T gives gamma/2pi, 1.04e8 rad/s/T gives gamma"),
    param("source", &Species::source, "where these constants come from",
          std::string_view{"the beamline file"}),
};

/// One part of a mixed beam.
struct Component {
  Species species;
  double fraction = 1;  // of all particles
  bool operator==(const Component&) const = default;
};

/// The built-in species: free particles, then atoms with the moment of their nucleus.
std::span<const Species> species_library();
/// The built-in species of that name, or nullptr.
const Species* find_species(std::string_view name);

}  // namespace rabiline
