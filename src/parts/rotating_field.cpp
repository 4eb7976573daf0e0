#include "parts/rotating_field.hpp"

#include "parts/alternating.hpp"

namespace rabiline {
namespace {

Turn turn_of(Sense sense) {
  switch (sense) {
    case Sense::co:
      return Turn::with_precession;
    case Sense::counter:
      return Turn::against_precession;
    case Sense::positive:
      return Turn::positive;
    case Sense::negative:
      break;
  }
  return Turn::negative;
}

}  // namespace

void contribute(const RotatingField& part, const Placement& place, SectionBuilder& builder) {
  RotatingTerm term;
  term.first = turned(Vector3{1, 0, 0}, part.tilt);
  term.second = turned(Vector3{0, 1, 0}, part.tilt);
  term.twist = part.twist / part.length;
  const Turn turn =
      part.sense ? turn_of(*part.sense) : Turn::positive;  // a follower's clock is another one's
  add_alternating(part, place, term, turn, builder);
}

std::vector<Fault> faults_of(const RotatingField& part, const Placement& place) {
  return faults_of_clock(part, place);
}

}  // namespace rabiline
