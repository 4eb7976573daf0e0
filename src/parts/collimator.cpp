#include "parts/collimator.hpp"

#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const Collimator& part, const Placement& place, SectionBuilder& builder) {
  const double end = place.at + part.length;
  if (const auto* disc = std::get_if<Disc>(&part.opening); disc && disc->radius > 0) {
    builder.bore(place.at, end, disc->radius, part.offset);
    return;
  }
  PlateTerm plate{opening_of(part.opening), part.offset, part.tilt};
  builder.plane(place.at, plate);
  plate.length = part.length;
  builder.plane(end, plate);
}

}  // namespace rabiline
