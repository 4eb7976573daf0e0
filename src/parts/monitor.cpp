#include "parts/monitor.hpp"

#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const Monitor& monitor, const Placement& place, SectionBuilder& builder) {
  builder.plane(place.at,
                MonitorTerm{opening_of(monitor.face), monitor.offset, monitor.tilt, monitor.tallies});
}

}  // namespace rabiline
