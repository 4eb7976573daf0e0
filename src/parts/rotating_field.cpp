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
  if (part.oscillator) {
    builder.zone(place.at, end, part.amplitude, part.phase.angle, *part.oscillator);
  } else {
    RotatingTerm clock;
    clock.frequency = part.frequency.value();
    clock.turn = turn_of(part.sense.value());
    clock.phase = part.phase.angle;
    clock.random_phase = part.phase.kind == Phase::Kind::random;
    builder.oscillator(place.name, clock);
    builder.zone(place.at, end, part.amplitude, 0, place.name);
  }
  if (part.bore) builder.bore(place.at, end, part.bore->radius);
}

}  // namespace rabiline
