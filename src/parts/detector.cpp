#include "parts/detector.hpp"

#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const Detector& detector, const Placement& place, SectionBuilder& builder) {
  builder.plane(place.at, ScreenTerm{{detector.width, detector.height},
                                     detector.offset,
                                     static_cast<int>(detector.bins.x),
                                     static_cast<int>(detector.bins.z)});
}

}  // namespace rabiline
