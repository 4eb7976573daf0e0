#include "parts/detector.hpp"

#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const Detector& detector, const Placement& place, SectionBuilder& builder) {
  ScreenTerm screen{detector.face, detector.offset, static_cast<int>(detector.bins.x),
                    static_cast<int>(detector.bins.z)};
  screen.tilt = detector.tilt;
  screen.efficiency = detector.efficiency;
  if (detector.dead) screen.dead = {opening_of(detector.dead->face), detector.dead->offset, detector.tilt};
  screen.tallies = detector.tallies;
  builder.plane(place.at, std::move(screen));
}

}  // namespace rabiline
