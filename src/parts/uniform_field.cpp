#include "parts/uniform_field.hpp"

#include "section/section_builder.hpp"

namespace rabiline {

StaticField static_field(const UniformField& part) {
  return {part.field * turned(part.direction, part.tilt), !(part.tilt == Tilt{})           ? "tilt"
                                                          : part.direction == UnitVector{} ? "field"
                                                                                           : "direction"};
}

void contribute(const UniformField& part, const Placement& place, SectionBuilder& builder) {
  const double end = place.at + part.length;
  builder.uniform(place.at, end, {part.field * turned(part.direction, part.tilt)});
  if (part.bore) builder.bore(place.at, end, part.bore->radius, part.offset);
}

}  // namespace rabiline
