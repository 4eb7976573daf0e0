#include "parts/slit.hpp"

#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const Slit& slit, const Placement& place, SectionBuilder& builder) {
  builder.plane(place.at, PlateTerm{slit.opening, slit.offset, slit.tilt});
}

std::vector<Fault> faults_of(const Slit& slit, const Placement& place) {
  return faults_of(slit.opening, place.name, "");
}

}  // namespace rabiline
