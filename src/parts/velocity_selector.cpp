#include "parts/velocity_selector.hpp"

#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const VelocitySelector&, const Placement& place, SectionBuilder& builder) {
  builder.plane(place.at, OwnStageTerm{});
}

}  // namespace rabiline
