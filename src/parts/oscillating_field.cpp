#include "parts/oscillating_field.hpp"

#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const OscillatingField& part, const Placement& place, SectionBuilder& builder) {
  const double end = place.at + part.length;
  RotatingTerm term;
  term.motion = part.approximation == Approximation::none ? Motion::swings : Motion::swings_in_rotating_wave;
  term.amplitude = part.amplitude;
  term.first = turned(part.direction, part.tilt);
  term.second = {};
  term.profile = profile_of(part.profile, place.at, part.length);
  if (part.oscillator) {
    term.phase = part.phase.angle;
  } else {
    RotatingTerm clock;
    clock.frequency = part.frequency.value();
    clock.phase = part.phase.angle;
    clock.random_phase = part.phase.kind == Phase::Kind::random;
    builder.oscillator(place.name, clock);
  }
  builder.zone(place.at, end, term, part.oscillator.value_or(place.name));
  if (part.bore) builder.bore(place.at, end, part.bore->radius, part.offset);
}

}  // namespace rabiline
