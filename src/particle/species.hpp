#pragma once
// What flies: mass, charge, and a spin with one gyromagnetic ratio or levels of two coupled spins.
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include "parameter/parameter.hpp"
#include "spin/coupled_spins.hpp"
#include "spin/half_integer.hpp"

namespace rabiline {

/// Two coupled angular momenta I and J, as an atom with hyperfine structure or a rotating molecule has them;
/// the Hamiltonian is that of HyperfineAtom (spin/atoms.hpp).
struct Structure {
  HalfInteger i, j;
  double coupling = 0;      // [Hz] A of A I.J
  double quadrupole = 0;    // [Hz] B of the interaction of quadrupole type
  double g_j = 0, g_i = 0;  // H/h = ... + (mu_B/h) B (g_J J_z + g_I' I_z)
  int levels() const { return (i.twice + 1) * (j.twice + 1); }
  bool operator==(const Structure&) const = default;
};
template <>
inline constexpr auto parameters<Structure> = std::tuple{
    param("I", &Structure::i, "nuclear spin, 0 to 9/2"),
    param("J", &Structure::j, "the other angular momentum: of the electrons, or of a rotating molecule"),
    param("coupling", &Structure::coupling, Dimension::frequency, range::any,
          "A of the interaction A I.J; negative where the largest F is the lowest; none of I = 0", 0.0),
    param("quadrupole", &Structure::quadrupole, Dimension::frequency, range::any,
          "B of the interaction of quadrupole type, for I and J of 1 or more", 0.0),
    param("g_J", &Structure::g_j, Dimension::number, range::any,
          "g factor of J in Bohr magnetons, positive for an electron"),
    param("g_I", &Structure::g_i, Dimension::number, range::any,
          "g factor g_I' of I in Bohr magnetons, negative for a positive moment"),
};
CoupledSpins coupled_spins(const Structure&);

/// A species with one moment, mu = gamma S, with signed gamma; or with the levels of a structure: then spin
/// and gamma are those of J alone, which the vector laws take. Uncertainties are standard ones; 0 is none
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
  std::optional<Structure> structure{};
  double electric_dipole_moment = 0;  // [C m] d of H = -d sigma.E, sigma = S/(I hbar)

  /// Of the Hamiltonian, under `quantum`.
  int levels() const { return structure ? structure->levels() : spin.twice + 1; }
  bool operator==(const Species&) const = default;
};

/// How a beamline file states the moment of a species.
struct GyromagneticRatio {
  static constexpr std::string_view kind = "moment by gamma", meaning = "gamma itself";
  double gyromagnetic_ratio = 0;  // [rad/(s T)] signed: mu = gamma S
  bool operator==(const GyromagneticRatio&) const = default;
};
template <>
inline constexpr auto parameters<GyromagneticRatio> = std::tuple{
    param("gyromagnetic_ratio", &GyromagneticRatio::gyromagnetic_ratio, Dimension::gyromagnetic, range::any,
          "signed gamma in mu = gamma S: 16.5 MHz/T gives gamma/2pi, 1.04e8 rad/s/T gives gamma"),
};
struct GFactor {
  static constexpr std::string_view kind = "moment by g", meaning = "gamma = g q/(2m)";
  double g_factor = 0;
  bool operator==(const GFactor&) const = default;
};
template <>
inline constexpr auto parameters<GFactor> = std::tuple{
    param(
        "g_factor", &GFactor::g_factor, Dimension::number, range::any,
        "g of a charge in gamma = g q/(2m), with the species' own charge and mass: 2 where spin and velocity "
        "turn alike"),
};
using Moment = std::variant<GyromagneticRatio, GFactor>;
template <>
inline constexpr std::string_view tag_key<Moment> = "";
template <>
inline constexpr std::string_view said_by_keys<Moment> = "its moment";

/// A species of one's own with one moment: what a beamline file states of it.
struct SpeciesWithMoment {
  std::string name;
  double mass = 0;    // [kg]
  double charge = 0;  // [C]
  HalfInteger spin;
  Moment moment{};
  double electric_dipole_moment = 0;  // [C m]
  std::string source;
  bool operator==(const SpeciesWithMoment&) const = default;
};
template <>
inline constexpr auto parameters<SpeciesWithMoment> = std::tuple{
    param("name", &SpeciesWithMoment::name, "what the species is called in messages and results"),
    param("mass", &SpeciesWithMoment::mass, Dimension::mass, range::positive, "mass, e.g. 7.016 u"),
    param("charge", &SpeciesWithMoment::charge, Dimension::charge, range::any, "charge, e.g. 0 e or 1 e"),
    param("spin", &SpeciesWithMoment::spin, "spin quantum number, 1/2 to 9/2, e.g. 3/2"),
    param("", &SpeciesWithMoment::moment, "the moment"),
    param("electric_dipole_moment", &SpeciesWithMoment::electric_dipole_moment, Dimension::electric_dipole,
          range::any, "d along the spin of a neutral particle, in H = -d sigma.E with sigma = S/(I hbar)",
          0.0),
    param("source", &SpeciesWithMoment::source, "where these constants come from",
          std::string_view{"the beamline file"}),
};

/// A species of one's own with levels: what a beamline file states of it.
struct SpeciesWithLevels {
  std::string name;
  double mass = 0;    // [kg]
  double charge = 0;  // [C]
  Structure structure;
  std::string source;
  bool operator==(const SpeciesWithLevels&) const = default;
};
template <>
inline constexpr auto parameters<SpeciesWithLevels> = std::tuple{
    param("name", &SpeciesWithLevels::name, "what the species is called in messages and results"),
    param("mass", &SpeciesWithLevels::mass, Dimension::mass, range::positive, "mass, e.g. 132.905 u"),
    param("charge", &SpeciesWithLevels::charge, Dimension::charge, range::any, "charge, e.g. 0 e or 1 e"),
    param("structure", &SpeciesWithLevels::structure,
          "two coupled spins: H/h = A I.J + (mu_B/h) B (g_J J_z + g_I I_z), and a quadrupole term"),
    param("source", &SpeciesWithLevels::source, "where these constants come from",
          std::string_view{"the beamline file"}),
};

/// One part of a mixed beam.
struct Component {
  Species species;
  double fraction = 1;  // of all particles
  bool operator==(const Component&) const = default;
};

/// Isotopes in the shares in which an element has them.
struct Mixture {
  std::string name;
  std::vector<Component> components;
};

/// The built-in species with one moment: free particles, then atoms with the moment of their nucleus.
std::span<const Species> species_library();
/// The built-in atoms and molecules with levels: "H atom", "ortho-H2".
std::span<const Species> species_with_levels();
/// "natural K", whose nuclei are points, and "natural K atom".
std::span<const Mixture> natural_mixtures();
/// The built-in mixture of that name, or nullptr.
const Mixture* find_mixture(std::string_view name);
/// A neutral species with the levels of a structure, and the spin and gamma that the vector laws take from
/// it.
Species with_levels(std::string name, double mass, const Structure&, std::string source);
/// gamma of a moment, g q/(2m) of a g factor [rad/(s T)].
double gyromagnetic_ratio(const Moment&, double charge, double mass);
/// The built-in species of that name, or nullptr.
const Species* find_species(std::string_view name);

}  // namespace rabiline
