#include "parts/guide_field.hpp"

#include <fmt/format.h>
#include <cmath>
#include <numbers>

#include "core/portable_math.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

StaticField static_field(const GuideField& part) {
  const bool turns = part.from != part.to;
  return {part.field * turned(part.from, part.tilt),
          turns                 ? "to"
          : part.tilt == Tilt{} ? "from"
                                : "tilt",
          turns};
}

void contribute(const GuideField& part, const Placement& place, SectionBuilder& builder) {
  const double end = place.at + part.length;
  const Vector3 from = turned(part.from, part.tilt), to = turned(part.to, part.tilt);
  const Vector3 axis = cross(from, to);
  const double sine = length_of(axis), angle = portable::atan2(sine, dot(from, to));
  const Vector3 second = sine > 0 ? cross((1 / sine) * axis, from) : Vector3{};
  const double twist = angle / part.length;
  if (!is_boxed(part.fringe, part.profile)) {
    FringedField fringed(shape_of(part.fringe, part.profile), place.at, part.length, part.offset);
    if (sine == 0) {
      fringed.add(part.field * from);
    } else {
      fringed.add_turning(part.field * from, twist, angle / 2);
      fringed.add_turning(part.field * second, twist, angle / 2 - std::numbers::pi / 2);
    }
    fringed.contribute(builder);
  } else if (sine == 0) {
    builder.uniform(place.at, end, {part.field * from});
  } else {
    RotatingTerm term;
    term.amplitude = part.field;
    term.first = from;
    term.second = second;
    term.twist = twist;
    term.envelope = {Shape::rectangular, place.at, part.length, 0};
    builder.twisted(place.at, end, term);
  }
  if (part.bore) builder.bore(place.at, end, part.bore->radius, part.offset);
}

/// A half turn could go either way round.
std::vector<Fault> faults_of(const GuideField& part, const Placement& place) {
  if (dot(part.from, part.to) >= -1 + 1e-9) return faults_of_fringe(part.fringe, part.profile, place);
  return {{place.name, "to",
           fmt::format("`{}` would turn its field by half a turn: which way round?", place.name),
           "make two guide fields of a quarter turn each"}};
}

}  // namespace rabiline
