#pragma once
// What fields with a clock have in common: their own oscillator or another one's, a zone, a bore.
#include "section/section_builder.hpp"

namespace rabiline {

/// Adds a part with `frequency`, `phase`, `oscillator`, `profile`, `length`, `bore`; `turn` is its own
/// clock's.
template <class Part>
void add_alternating(const Part& part, const Placement& place, RotatingTerm term, Turn turn,
                     SectionBuilder& builder) {
  const double end = place.at + part.length;
  term.amplitude = part.amplitude;
  term.envelope = envelope_of(part.profile, place.at, part.length);
  if (part.oscillator)
    term.oscillator.phase = part.phase.angle;
  else
    builder.oscillator(place.name, {.frequency = part.frequency.value(),
                                    .turn = turn,
                                    .phase = part.phase.angle,
                                    .random_phase = part.phase.kind == Phase::Kind::random});
  builder.zone(place.at, end, term, part.oscillator.value_or(place.name));
  if (part.bore) builder.bore(place.at, end, part.bore->radius, part.offset);
}

}  // namespace rabiline
