#include "particle/species.hpp"

#include <array>

#include "core/constants.hpp"

namespace rabiline {
namespace {

using constants::atomic_mass;
using constants::elementary_charge;
using constants::two_pi;

}  // namespace

std::span<const Species> species_library() {
  // Every moment is a point moment mu = gamma S with signed gamma. The ratios are gamma/2pi in MHz/T.
  static const std::array library{
      Species{"neutron",
              1.67492750056e-27,
              0,
              {1},
              two_pi * -29.1646935e6,
              "CODATA 2022: neutron mass, neutron gyromagnetic ratio"},
      Species{"proton",
              1.67262192595e-27,
              elementary_charge,
              {1},
              two_pi * 42.577478461e6,
              "CODATA 2022: proton mass, proton gyromagnetic ratio"},
      Species{"electron",
              9.1093837139e-31,
              -elementary_charge,
              {1},
              two_pi * -28024.9513861e6,
              "CODATA 2022: electron mass, electron gyromagnetic ratio"},
      Species{
          "H",
          1.007825031898 * atomic_mass,
          0,
          {1},
          two_pi * 42.577478461e6,
          "AME2020: mass of the hydrogen atom; CODATA 2022: proton gyromagnetic ratio. The nuclear moment "
          "alone: the electron's moment is left out"},
      Species{
          "Li-7",
          7.0160034 * atomic_mass,
          0,
          {3},
          two_pi * 16.54828e6,
          "AME2020: mass of the lithium atom; N. Stone, INDC(NDS)-0658 (2014): nuclear moment. The nuclear "
          "moment alone: the electron's moment is left out"},
  };
  return library;
}

const Species* find_species(std::string_view name) {
  for (const Species& species : species_library())
    if (species.name == name) return &species;
  return nullptr;
}

}  // namespace rabiline
