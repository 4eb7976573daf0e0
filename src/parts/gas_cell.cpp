#include "parts/gas_cell.hpp"

#include "core/constants.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

double density_of(const Gas& gas) {
  if (const auto* ideal = std::get_if<GasPressure>(&gas))
    return ideal->pressure / (constants::boltzmann * ideal->temperature);
  return std::get<GasDensity>(gas).density;
}

void contribute(const GasCell& part, const Placement& place, SectionBuilder& builder) {
  if (part.bore) builder.bore(place.at, place.at + part.length, part.bore->radius, part.offset);
  builder.plane(place.at, OwnStageTerm{});
}

}  // namespace rabiline
