#include "parts/oscillating_field.hpp"

#include "parts/alternating.hpp"

namespace rabiline {

void contribute(const OscillatingField& part, const Placement& place, SectionBuilder& builder) {
  RotatingTerm term;
  term.motion =
      part.approximation == Approximation::none ? FieldMotion::swings : FieldMotion::swings_in_rotating_wave;
  term.first = turned(part.direction, part.tilt);
  term.second = {};
  term.twist = part.phase_advance / part.length;
  add_alternating(part, place, term, Turn::positive, builder);
}

std::vector<Fault> faults_of(const OscillatingField& part, const Placement& place) {
  return faults_of_clock(part, place);
}

}  // namespace rabiline
