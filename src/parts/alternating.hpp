#pragma once
// What fields with a clock have in common: their own oscillator or another one's, a zone, a bore.
#include <fmt/format.h>

#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "parts/fringe.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

/// A field with a fringe: what swings along either axis, and what Maxwell's equations have beside the beam's.
template <class Part>
void add_fringed(const Part& part, const Placement& place, const RotatingTerm& term,
                 const std::string& oscillator, SectionBuilder& builder) {
  for (const auto& [axis, lag] : {std::pair{term.first, 0.0}, std::pair{term.second, std::numbers::pi / 2}}) {
    FringedField fringed(shape_of(part.fringe, RectangularProfile{}), place.at, part.length, part.offset);
    fringed.add(part.amplitude * axis);
    fringed.contribute_swinging(builder, oscillator, term.oscillator.phase, lag);
  }
}

/// Adds a part with `frequency`, `phase`, `oscillator`, `profile`, `fringe`, `length`, `bore`; `turn` is its
/// own clock's.
template <class Part>
void add_alternating(const Part& part, const Placement& place, RotatingTerm term, Turn turn,
                     SectionBuilder& builder) {
  const double end = place.at + part.length;
  term.amplitude = part.amplitude;
  term.envelope = envelope_of(part.profile, place.at, part.length);
  term.gate = gate_of(part.pulses);
  term.slopes = slopes_of(part.phase_gradient, part.amplitude_gradient, part.offset);
  if (part.oscillator)
    term.oscillator.phase = part.phase.angle;
  else
    builder.oscillator(place.name, {.frequency = part.frequency.value(),
                                    .turn = turn,
                                    .phase = part.phase.angle,
                                    .random_phase = part.phase.kind == Phase::Kind::random,
                                    .sweep = sweep_of(part.sweep, part.frequency.value())});
  const std::string& oscillator = part.oscillator ? *part.oscillator : place.name;
  if (std::holds_alternative<HardFringe>(part.fringe))
    builder.zone(place.at, end, term, oscillator);
  else
    add_fringed(part, place, term, oscillator, builder);
  if (part.bore) builder.bore(place.at, end, part.bore->radius, part.offset);
}

/// What a sweep cannot mean; it is the clock's.
template <class Part>
void check_sweep(const Part& part, const std::string& name, std::vector<Fault>& out) {
  if (!part.sweep) return;
  const FrequencySweep& sweep = *part.sweep;
  if (part.oscillator)
    out.push_back({name, "sweep",
                   fmt::format("`{}` has a `sweep` of its own, but it follows the clock of `{}`", name,
                               *part.oscillator),
                   "omit `sweep`, or `oscillator`"});
  else if (sweep.end <= sweep.begin)
    out.push_back({name, "sweep.end", fmt::format("the sweep of `{}` ends before it begins", name),
                   "make `end` later than `begin`"});
  else if (part.frequency && (sweep.to <= 0 || *part.frequency <= 0))
    out.push_back(
        {name, "sweep.to",
         fmt::format("the sweep of `{}` from {} to {} goes through zero frequency, where a field neither "
                     "turns nor swings",
                     name, pretty_quantity(*part.frequency, Dimension::frequency),
                     pretty_quantity(sweep.to, Dimension::frequency)),
         "keep both ends above zero; a field that turns the other way has the other `sense`"});
}

/// What a train of pulses cannot mean.
template <class Part>
void check_pulses(const Part& part, const std::string& name, std::vector<Fault>& out) {
  if (!part.pulses) return;
  const PulseTrain& train = *part.pulses;
  const double length = train.end - train.begin;
  if (length <= 0)
    out.push_back({name, "pulses.end", fmt::format("`{}` is switched off before it is switched on", name),
                   "make `end` later than `begin`"});
  else if (train.times && *train.times > 1 && !train.period)
    out.push_back(
        {name, "pulses.times",
         fmt::format("`{}` does not say how soon its {} pulses follow each other", name, *train.times),
         "add `period`, or omit `times` for one pulse"});
  else if (train.period && *train.period < length)
    out.push_back({name, "pulses.period",
                   fmt::format("pulses of {} that follow each other every {} would overlap",
                               pretty_quantity(length, Dimension::time),
                               pretty_quantity(*train.period, Dimension::time)),
                   "make `period` longer, or omit `pulses` for a field that is always on"});
}

/// What a field with a fringe, which swings at all places at once, cannot have.
template <class Part>
void check_fringe(const Part& part, const Placement& place, std::vector<Fault>& out) {
  if (std::holds_alternative<HardFringe>(part.fringe)) return;
  const auto check = [&](bool given, const char* key) {
    if (given)
      out.push_back({place.name, key,
                     fmt::format("`{}` cannot have both a `fringe` and `{}`", place.name, key),
                     fmt::format("omit `{}`, or `fringe`", key)});
  };
  check(!std::holds_alternative<RectangularProfile>(part.profile), "profile");
  check(part.pulses.has_value(), "pulses");
  check(part.phase_gradient != PhaseGradient{}, "phase_gradient");
  check(part.amplitude_gradient != AmplitudeGradient{}, "amplitude_gradient");
  if constexpr (requires { part.twist; }) check(part.twist != 0, "twist");
  if constexpr (requires { part.phase_advance; }) check(part.phase_advance != 0, "phase_advance");
  if constexpr (requires { part.approximation; })
    if (part.approximation != decltype(part.approximation)::none)
      out.push_back({place.name, "approximation",
                     fmt::format("`{}` has a fringe, so that its whole field acts", place.name),
                     "write `approximation: none`, or omit `fringe`"});
  for (Fault& fault : faults_of_fringe(part.fringe, RectangularProfile{}, place))
    out.push_back(std::move(fault));
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
      out.push_back(
          {name, std::string(key),
           fmt::format("`{}` has a `{}` of its own, but it follows the clock of `{}`", name, key,
                       *part.oscillator),
           fmt::format("omit `{}`, or `oscillator`: `{}.{}` is that of both", key, *part.oscillator, key)});
  };
  if (part.oscillator == name)
    out.push_back(
        {name, "oscillator", fmt::format("`{}` cannot follow its own clock", name), "omit `oscillator`"});
  check("frequency", part.frequency.has_value(), "291.6 kHz");
  if constexpr (requires { part.sense; }) check("sense", part.sense.has_value(), "co");
  check_sweep(part, name, out);
  check_pulses(part, name, out);
  check_fringe(part, place, out);
  if (part.oscillator && part.phase.kind == Phase::Kind::random)
    out.push_back({name, "phase",
                   fmt::format("the phase of `{}` cannot be random: it follows the clock of `{}`", name,
                               *part.oscillator),
                   "write `locked`, or the angle by which it runs ahead"});
  return out;
}

}  // namespace rabiline
