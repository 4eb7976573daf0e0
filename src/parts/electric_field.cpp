#include "parts/electric_field.hpp"

#include "parts/own_frame.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const ElectricField& part, const Placement& place, SectionBuilder& builder) {
  const double end = place.at + part.length;
  const Vector3 field = part.field * turned(part.direction, part.tilt);
  if (part.bore) builder.bore(place.at, end, part.bore->radius, part.offset);
  if (field == Vector3{}) return;
  if (std::holds_alternative<HardFringe>(part.fringe))
    return builder.electric(place.at, end, ShapedTerm(LinearShape{{field.x, field.y, field.z}, {}}));
  FringedField fringed(shape_of(part.fringe, RectangularProfile{}), place.at, part.length, part.offset);
  fringed.add(field);
  fringed.contribute_electric(builder);
}

std::vector<Fault> faults_of(const ElectricField& part, const Placement& place) {
  return faults_of_fringe(part.fringe, RectangularProfile{}, place);
}

}  // namespace rabiline
