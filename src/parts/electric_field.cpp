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
  const FringeShape shape = shape_of(part.fringe, RectangularProfile{});
  const double reach = reach_of(shape).value_or(0);
  for (const ShapedTerm& term :
       fringed_terms(shape, part.length, field, place_of(place.at + part.length / 2, part.offset)))
    builder.electric(std::max(0.0, place.at - reach), end + reach, term);
  for (const double y : kinks_of(shape, place.at, part.length)) builder.kink(y);
}

std::vector<Fault> faults_of(const ElectricField& part, const Placement& place) {
  return faults_of_fringe(part.fringe, RectangularProfile{}, place);
}

}  // namespace rabiline
