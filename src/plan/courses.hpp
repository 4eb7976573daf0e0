#pragma once
// How particles are flown through a zone that turns their velocity: the cheapest way that keeps the path's
// error.
#include "transport/region.hpp"

namespace rabiline {

/// What is known before it of the flight of the slowest particles through a zone.
struct ZoneOutlook {
  double stay = 0;                       // [s]
  double slowness = 1;                   // how many times longer than at the mean speed
  double rate = 0;                       // [rad/s] of the fastest turning
  double tip = 1;                        // largest sine of the angle between spin and field, up to its end
  double path_error = 0;                 // over the length of the flight
  bool take_off_spin_component = false;  // closure torque
};

/// The constants of a course through one rotating field, in spans of that length [s].
SpanTable span_table(const SpinZone&, double span, ZoneCourse);

/// Sets course and table of a zone whose fields and steps stand; what has no closed form keeps the steps.
void choose_course(RegionZone&, const ZoneOutlook&);

}  // namespace rabiline
