#include "parts/detector.hpp"

#include <fmt/format.h>

#include "core/portable_math.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

namespace {

/// Displacement of its centre from the beam's axis: it is a part of the face.
Offset place_of_dead_area(const Detector& detector) {
  const Offset on_face = detector.dead->offset, centre = detector.offset;
  if (detector.tilt.y == 0) return {centre.x + on_face.x, centre.z + on_face.z};
  const double c = portable::cos(detector.tilt.y), s = portable::sin(detector.tilt.y);
  return {centre.x + c * on_face.x + s * on_face.z, centre.z + c * on_face.z - s * on_face.x};
}

}  // namespace

void contribute(const Detector& detector, const Placement& place, SectionBuilder& builder) {
  ScreenTerm screen{detector.face, detector.offset, static_cast<int>(detector.bins.x),
                    static_cast<int>(detector.bins.z)};
  screen.tilt = detector.tilt;
  screen.efficiency = detector.efficiency;
  if (detector.dead)
    screen.dead = {opening_of(detector.dead->face), place_of_dead_area(detector), detector.tilt};
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
