#include "parts/guide_field.hpp"

#include <cmath>

#include "core/portable_math.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const GuideField& part, const Placement& place, SectionBuilder& builder) {
  const double end = place.at + part.length;
  const Vector3 from = turned(part.from, part.tilt), to = turned(part.to, part.tilt);
  const Vector3 axis = cross(from, to);
  const double sine = length_of(axis), angle = portable::atan2(sine, dot(from, to));
  if (sine == 0) {
    builder.uniform(place.at, end, {part.field * from});
  } else {
    RotatingTerm term;
    term.amplitude = part.field;
    term.first = from;
    term.second = cross((1 / sine) * axis, from);
    term.twist = angle / part.length;
    term.profile = {Shape::rectangular, place.at, part.length, 0};
    builder.twisted(place.at, end, term);
  }
  if (part.bore) builder.bore(place.at, end, part.bore->radius, part.offset);
}

}  // namespace rabiline
