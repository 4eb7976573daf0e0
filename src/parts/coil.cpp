#include "parts/coil.hpp"

#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const Coil& part, const Placement& place, SectionBuilder& builder) {
  const double end = place.at + part.length;
  builder.coil(place.at, end, {turned(part.axis, part.tilt), part.angle, part.length, part.speed});
  if (part.bore) builder.bore(place.at, end, part.bore->radius, part.offset);
}

}  // namespace rabiline
