#include "parts/chopper.hpp"

#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const Chopper&, const Placement& place, SectionBuilder& builder) {
  builder.plane(place.at, OwnStageTerm{});
}

}  // namespace rabiline
