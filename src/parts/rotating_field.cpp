#include "parts/rotating_field.hpp"

#include "section/section_builder.hpp"

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
  const double end = place.at + part.length;
  RotatingTerm term;
  term.amplitude = part.amplitude;
  term.first = turned(Vector3{1, 0, 0}, part.tilt);
  term.second = turned(Vector3{0, 1, 0}, part.tilt);
  term.twist = part.twist / part.length;
  term.profile = profile_of(part.profile, place.at, part.length);
  if (part.oscillator) {
    term.phase = part.phase.angle;
  } else {
    RotatingTerm clock;
    clock.frequency = part.frequency.value();
    clock.turn = turn_of(part.sense.value());
    clock.phase = part.phase.angle;
    clock.random_phase = part.phase.kind == Phase::Kind::random;
    builder.oscillator(place.name, clock);
  }
  builder.zone(place.at, end, term, part.oscillator.value_or(place.name));
  if (part.bore) builder.bore(place.at, end, part.bore->radius, part.offset);
}

}  // namespace rabiline
