#include "parts/beam_stop.hpp"

#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const BeamStop& part, const Placement& place, SectionBuilder& builder) {
  builder.plane(place.at, PlateTerm{part.shape, part.offset, part.tilt, true});
}

std::vector<Fault> faults_of(const BeamStop& part, const Placement& place) {
  return faults_of(part.shape, place.name, "");
}

}  // namespace rabiline
