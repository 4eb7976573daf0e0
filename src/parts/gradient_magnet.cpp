#include "parts/gradient_magnet.hpp"

#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const GradientMagnet& part, const Placement& place, SectionBuilder& builder) {
  const double end = place.at + part.length;
  builder.plane(place.at, MagnetTerm{end, part.gradient, part.along, part.gap, part.offset});
  builder.uniform(place.at, end, {{0, 0, part.field}});
}

}  // namespace rabiline
