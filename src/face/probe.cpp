#include "face/probe.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "core/constants.hpp"
#include "field/fringe_limit.hpp"
#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "plan/zones.hpp"
#include "section/section_builder.hpp"

namespace rabiline {
namespace {

struct Here : FieldHere<double> {
  FieldHere<double> electric;
  double good_up_to;  // [m] 0 where all is good
};

void look_at_fringe(const ShapedTerm& term, const Vector3& place, Here& sum) {
  if (term.kind != ShapedKind::fringed) return;
  const double good = good_up_to(term.fringed);
  if (distance_from_axis(term, place.x, place.y, place.z) > good) sum.good_up_to = good;
}

void add_uniform(const Vector3& field, Here& sum) {
  sum.field[0] += field.x;
  sum.field[1] += field.y;
  sum.field[2] += field.z;
}

/// By what a drive has turned.
double known(double angle, double time) {
  if (std::abs(angle) <= most_phase) return angle;
  throw std::invalid_argument(
      fmt::format("at {:.3g} s a drive has turned by more than {:.0e} radians: its phase is no longer known",
                  time, most_phase));
}

/// Its slope along the beam is that of its envelope and its twist, by differences.
void add_rotating(const RotatingTerm& term, double gamma, const Vector3& place, double time, Here& sum) {
  const Oscillator& clock = term.oscillator;
  const double sense = term.motion == FieldMotion::turns ? clock.sense(gamma) : 1;
  const double of_place = phase_of(term.slopes, place.x, place.z),
               share = is_on(term.gate, time) ? share_of(term.slopes, place.x, place.z) : 0;
  const auto field = [&](double at) {
    const double angle = known(clock.omega(gamma) * time, time) + clock.phase +
                         term.twist * (at - term.envelope.begin) +
                         known(2 * std::numbers::pi * sense * swept(clock.sweep, time), time) + of_place;
    const Vector3 along = portable::cos(angle) * term.first;
    return (term.amplitude * share * share_of(term.envelope, at)) *
           (term.motion == FieldMotion::turns ? along + portable::sin(angle) * term.second : along);
  };
  constexpr double h = 1e-6;  // [m]
  add_uniform(field(place.y), sum);
  const Vector3 slope = (0.5 / h) * (field(place.y + h) - field(place.y - h));
  sum.slope[1] += slope.x;
  sum.slope[4] += slope.y;
  sum.slope[7] += slope.z;
}

void add_swinging(const SwingingTerm& term, double gamma, const Vector3& place, double time, Here& sum) {
  const Oscillator& clock = term.oscillator;
  const double turned = clock.frequency * time + swept(clock.sweep, time),
               share =
                   portable::cos(known(2 * std::numbers::pi * turned, time) + clock.phase_of_swing(gamma));
  FieldHere<double> peak{};
  add_field<HostMaths>(term.field, place.x, place.y, place.z, peak);
  for (int i = 0; i < 3; ++i) sum.field[i] += share * peak.field[i];
  for (int i = 0; i < 9; ++i) sum.slope[i] += share * peak.slope[i];
}

/// What some parts of a beamline make there together.
Here field_of_parts(const Beamline& beamline, const std::vector<const PlacedPart*>& parts,
                    const Vector3& place, double time) {
  SectionBuilder builder(Wall{});
  for (const PlacedPart* part : parts)
    std::visit([&](const auto& any) { contribute(any, part->placement, builder); }, part->part);
  const Species first = beamline.species.empty() ? Species{} : beamline.species.front().species;
  Here sum{};
  const Magnets magnets = law_traits(beamline.law).has_forces ? Magnets::fields : Magnets::uniform;
  for (const Section& section : builder.build(magnets).sections) {
    if (place.y < section.begin || place.y >= section.end) continue;
    add_uniform(section.field, sum);
    for (const CoilTerm& coil : section.coils) add_uniform(coil.field(first), sum);
    for (const RotatingTerm& term : section.rotating)
      add_rotating(term, first.gyromagnetic_ratio, place, time, sum);
    for (const ShapedTerm& term : section.shaped) {
      add_field_at<HostMaths>(term, place.x, place.y, place.z, time, sum);
      look_at_fringe(term, place, sum);
    }
    for (const SwingingTerm& term : section.swinging) {
      add_swinging(term, first.gyromagnetic_ratio, place, time, sum);
      look_at_fringe(term.field, place, sum);
    }
    for (const ShapedTerm& term : section.electric) {
      add_field<HostMaths>(term, place.x, place.y, place.z, sum.electric);
      look_at_fringe(term, place, sum);
    }
  }
  return sum;
}

const PlacedPart* clock_part(const Beamline& beamline, const PlacedPart& part) {
  const std::string* clock = clock_of(part.part);
  if (!clock) return nullptr;
  for (const PlacedPart& other : beamline.parts)
    if (other.placement.name == *clock && &other != &part) return &other;
  return nullptr;
}

bool is_zero(const Here& here) {
  const auto zero = [](double x) { return x == 0; };
  return std::all_of(std::begin(here.field), std::end(here.field), zero) &&
         std::all_of(std::begin(here.slope), std::end(here.slope), zero) &&
         std::all_of(std::begin(here.electric.field), std::end(here.electric.field), zero);
}

}  // namespace

Probed probe_of(const Beamline& beamline, const Vector3& place, double time) {
  Probed out;
  out.place = {place.x, place.y, place.z};
  for (const PlacedPart& part : beamline.parts) {
    if (!traits_of(part.part).field) continue;
    // A part that follows a clock cannot stand without it: both, less the clock's own.
    const PlacedPart* clock = clock_part(beamline, part);
    Here own = clock ? field_of_parts(beamline, {clock, &part}, place, time)
                     : field_of_parts(beamline, {&part}, place, time);
    if (clock) {
      const Here other = field_of_parts(beamline, {clock}, place, time);
      for (int i = 0; i < 3; ++i) own.field[i] -= other.field[i];
      for (int i = 0; i < 9; ++i) own.slope[i] -= other.slope[i];
    }
    if (is_zero(own)) continue;
    Probed::Contribution contribution{part.placement.name, {}, {}, own.good_up_to};
    for (std::size_t i = 0; i < 3; ++i) {
      contribution.field[i] = own.field[i];
      contribution.electric[i] = own.electric.field[i];
      out.field[i] += own.field[i];
      out.electric[i] += own.electric.field[i];
    }
    for (std::size_t i = 0; i < 9; ++i) out.slope[i] += own.slope[i];
    out.contributions.push_back(contribution);
  }
  return out;
}

}  // namespace rabiline
