#include "parts/multipole_field.hpp"

#include "parts/magnet_rules.hpp"
#include "parts/own_frame.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const MultipoleField& part, const Placement& place, SectionBuilder& builder) {
  const MultipoleShape shape{static_cast<int>(part.poles) / 2 - 1, part.field, part.radius};
  add_shaped(
      clock_of(part.oscillates), place.at, place.at + part.length,
      placed(ShapedTerm(shape), place_of(place.at + part.length / 2, part.offset), turned_frame(part.tilt)),
      builder);
}

std::vector<Fault> faults_of(const MultipoleField& part, const Placement& place) {
  return faults_of_poles(part.poles, place);
}

}  // namespace rabiline
