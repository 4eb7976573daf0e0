#include "parts/detector.hpp"

#include <fmt/format.h>

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

std::vector<Fault> faults_of(const Detector& detector, const Placement& place) {
  std::vector<Fault> out = faults_of_size(detector.face, place.name, "", fmt::format("`{}`", place.name));
  if (detector.dead)
    for (Fault& fault : faults_of_size(detector.dead->face, place.name, "dead",
                                       fmt::format("the dead area of `{}`", place.name)))
      out.push_back(std::move(fault));
  return out;
}

}  // namespace rabiline
