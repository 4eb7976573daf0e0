#include "parts/monitor.hpp"

#include <cmath>

#include "section/section_builder.hpp"

namespace rabiline {

double place_of_plane(const Monitor& monitor, const Placement& place, std::size_t plane) {
  if (plane == 0) return place.at;
  return std::lerp(place.at, place.at + monitor.length,
                   static_cast<double>(plane) / static_cast<double>(monitor.planes - 1));
}

void contribute(const Monitor& monitor, const Placement& place, SectionBuilder& builder) {
  for (std::size_t i = 0; i < monitor.planes; ++i)
    builder.plane(place_of_plane(monitor, place, i),
                  MonitorTerm{opening_of(monitor.face), monitor.offset, monitor.tilt, monitor.tallies,
                              static_cast<int>(i)});
}

}  // namespace rabiline
