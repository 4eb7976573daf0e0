#pragma once
// What fields with a clock have in common: their own oscillator or another one's, a zone, a bore.
#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

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

/// A clock of its own has a frequency and, of a field that turns, a sense; one that is followed gives both.
template <class Part>
std::vector<Fault> faults_of_clock(const Part& part, const Placement& place) {
  const std::string& name = place.name;
  std::vector<Fault> out;
  const auto check = [&](std::string_view key, bool given, std::string_view example) {
    if (!given && !part.oscillator)
      out.push_back(
          {name, "kind", fmt::format("the {} `{}` needs `{}`", Part::kind, name, key),
           fmt::format("add `{}: {}`, or `oscillator` and the name of a zone whose clock it follows", key,
                       example)});
    if (given && part.oscillator)
      out.push_back({name, std::string(key),
                     fmt::format("`{}` has a `{}` of its own, but it follows the clock of `{}`", name, key,
                                 *part.oscillator),
                     fmt::format("omit `{}`, or `oscillator`", key)});
  };
  if (part.oscillator == name)
    out.push_back(
        {name, "oscillator", fmt::format("`{}` cannot follow its own clock", name), "omit `oscillator`"});
  check("frequency", part.frequency.has_value(), "291.6 kHz");
  if constexpr (requires { part.sense; }) check("sense", part.sense.has_value(), "co");
  if (part.oscillator && part.phase.kind == Phase::Kind::random)
    out.push_back({name, "phase",
                   fmt::format("the phase of `{}` cannot be random: it follows the clock of `{}`", name,
                               *part.oscillator),
                   "write `locked`, or the angle by which it runs ahead"});
  return out;
}

}  // namespace rabiline
