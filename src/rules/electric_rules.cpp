// What cannot fly through electric fields.
#include <algorithm>
#include <cmath>

#include "core/constants.hpp"
#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "particle/speed.hpp"
#include "rules/room.hpp"
#include "section/section_builder.hpp"

namespace rabiline {
namespace {

/// The line integral of E along the axis, to where it is largest [V] for a positive and a negative charge.
struct Voltage {
  double highest = 0, lowest = 0;
};
Voltage voltage_along(const Sections& sections) {
  constexpr int places = 64;
  Voltage out;
  double sum = 0;
  for (const Section& section : sections.sections)
    for (int i = 0; i < places && !section.electric.empty(); ++i) {
      FieldHere<double> here{};
      const double step = (section.end - section.begin) / places;
      for (const ShapedTerm& term : section.electric)
        add_field<HostMaths>(term, 0.0, section.begin + (i + 0.5) * step, 0.0, here);
      sum += here.field[1] * step;
      out.highest = std::max(out.highest, sum);
      out.lowest = std::min(out.lowest, sum);
    }
  return out;
}

void check_electric(const PlacedPart& part, const Beamline& beamline, const Component& component,
                    Faults& out) {
  const std::string& name = part.placement.name;
  const Species& species = component.species;
  if (species.structure)
    out.push_back(
        {name, "kind",
         fmt::format("`{}` is an electric field, and what it does to the levels of `{}`, their Stark "
                     "shifts, is not modelled",
                     name, species.name),
         "omit it, or fly a species with one moment"});
  else if (species.charge != 0 && law_traits(beamline.law).kappa != 0)
    out.push_back(
        {name, "kind",
         fmt::format("`{}` is an electric field, and what dorado makes of the force on the charge of "
                     "`{}` is undefined: the equations of its paper for such fields, (42)-(50), are "
                     "missing",
                     name, species.name),
         "write `law: quantum` or `law: classical`, or fly a neutral species"});
}

void check_final_speed(const Component& component, const std::string& name, const Voltage& voltage,
                       const Beamline& beamline, Faults& out) {
  const Species& s = component.species;
  const double gain = s.charge * (s.charge > 0 ? voltage.highest : voltage.lowest),
               start = mean_speed(beamline.source.speed, s.mass),
               speed = std::sqrt(start * start + 2 * gain / s.mass);
  if (speed <= fastest_speed) return;
  out.push_back(
      {name, "field",
       fmt::format("`{}` leaves the electric field on the axis with {:.4g} m/s, faster than 0.05 c = "
                   "{:.4g} m/s: this program knows no relativity",
                   s.name, speed, fastest_speed),
       "make the field smaller or shorter"});
}

}  // namespace

void check_electric_fields(const Beamline& beamline, Faults& out) {
  for (std::size_t i = 0; i < beamline.species.size(); ++i)
    if (const Species& s = beamline.species[i].species; s.electric_dipole_moment != 0 && s.charge != 0)
      out.push_back(
          {"species", key_of_species(i, "electric_dipole_moment"),
           fmt::format("`{}` has a charge and an electric dipole moment, on which v x B would act as "
                       "much as E, and that is not modelled",
                       s.name),
           "write `charge: 0 e`, or omit the moment"});
  SectionBuilder builder(Wall{});
  const std::string* last = nullptr;
  for (const PlacedPart& part : beamline.parts) {
    if (!is_electric(part.part)) continue;
    last = &part.placement.name;
    for (const Component& component : beamline.species) check_electric(part, beamline, component, out);
    std::visit([&](const auto& any) { contribute(any, part.placement, builder); }, part.part);
  }
  if (last == nullptr) return;
  const Voltage voltage = voltage_along(builder.build());
  for (const Component& component : beamline.species)
    check_final_speed(component, *last, voltage, beamline, out);
}

}  // namespace rabiline
