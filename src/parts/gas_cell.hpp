#pragma once
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

struct GasDensity {
  static constexpr std::string_view kind = "density", meaning = "so many molecules in a volume";
  double density = 0;  // [1/m^3]
  bool operator==(const GasDensity&) const = default;
};
template <>
inline constexpr auto parameters<GasDensity> = std::tuple{
    param("density", &GasDensity::density, Dimension::number_density, range::not_negative,
          "molecules in a volume"),
};
/// An ideal gas: p = n k T.
struct GasPressure {
  static constexpr std::string_view kind = "pressure",
                                    meaning = "an ideal gas of some pressure and temperature";
  double pressure = 0;     // [Pa]
  double temperature = 0;  // [K]
  bool operator==(const GasPressure&) const = default;
};
template <>
inline constexpr auto parameters<GasPressure> = std::tuple{
    param("pressure", &GasPressure::pressure, Dimension::pressure, range::not_negative, "of an ideal gas"),
    param("temperature", &GasPressure::temperature, Dimension::temperature, range::positive, "of the gas"),
};
using Gas = std::variant<GasDensity, GasPressure>;
template <>
inline constexpr std::string_view tag_key<Gas> = "";
template <>
inline constexpr std::string_view said_by_keys<Gas> = "its gas";
/// Molecules in a volume [1/m^3].
double density_of(const Gas&);

/// Gas along a stretch of the beam. Of a particle's weight exp(-n sigma l) goes on, l its straight path
/// through the cell, or up to the wall that it meets; the rest is scattered and ends there.
struct GasCell {
  static constexpr std::string_view kind = "gas_cell",
                                    meaning = "gas that scatters particles out of the beam";
  static constexpr PartTraits traits{.one_way = true};
  double length = 0;  // [m]
  Gas gas;
  double cross_section = 0;  // [m^2] for all that takes a particle out of the beam
  std::optional<Bore> bore{};
  Offset offset{};
  bool operator==(const GasCell&) const = default;
};
template <>
inline constexpr auto parameters<GasCell> = std::tuple{
    param("length", &GasCell::length, Dimension::length, range::positive, "extent along the beam"),
    param("", &GasCell::gas, "the gas: density, or pressure and temperature"),
    param("cross_section", &GasCell::cross_section, Dimension::area, range::not_negative,
          "for all that takes a particle out of the beam"),
    param("bore", &GasCell::bore, "wall around the gas; none if omitted"),
    param("offset", &GasCell::offset, "displacement of the bore's centre from the axis", Offset{}),
};

void contribute(const GasCell&, const Placement&, SectionBuilder&);

}  // namespace rabiline
