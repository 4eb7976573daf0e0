#include "parts/spin_filter.hpp"

#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const SpinFilter& part, const Placement& place, SectionBuilder& builder) {
  builder.plane(place.at, FilterTerm{turned(part.axis, part.tilt), part.up, part.down});
}

}  // namespace rabiline
