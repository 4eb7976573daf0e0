// A source that cannot be as it is written: speeds and directions.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/portable_math.hpp"
#include "particle/draw.hpp"
#include "rules/room.hpp"

namespace rabiline {
namespace {

double area_of(const Opening& opening) {
  if (const auto* r = std::get_if<Rectangle>(&opening)) return r->width * r->height;
  if (const auto* ring = std::get_if<Ring>(&opening)) return ring->outer_radius - ring->inner_radius;
  return std::get<Disc>(opening).radius;
}

void check_aim(const Beamline& beamline, Faults& out) {
  const auto* aimed = std::get_if<AimedDirection>(&beamline.source.direction);
  if (!aimed) return;
  const auto add = [&](std::string message, std::string help) {
    out.push_back({"source", "direction.target", std::move(message), std::move(help)});
  };
  const PlacedPart* target = find_part(beamline, aimed->target);
  if (!target || !traits_of(target->part).target)
    return add(target ? fmt::format("`{}` is a {}, but a source is aimed at a slit or a detector",
                                    aimed->target, kind_of(target->part))
                      : fmt::format("there is no slit or detector `{}` to aim the source at", aimed->target),
               suggest_name(aimed->target, names_of_parts(beamline, [](const PlacedPart& part) {
                              return traits_of(part.part).target;
                            })));
  const double at = target->placement.at;
  if (!(at > 0))
    out.push_back({aimed->target, "at",
                   fmt::format("the source is aimed at `{}`, which must stand behind it, not in its plane",
                               aimed->target),
                   "give it an `at` greater than zero"});
  if (area_of(across_of(target->part)->opening) == 0)
    add(fmt::format("the source is aimed at `{}`, whose opening has no area", aimed->target),
        "open the slit");
  const auto field = std::find_if(beamline.parts.begin(), beamline.parts.end(), [&](const PlacedPart& p) {
    return traits_of(p.part).field && p.placement.at < at;
  });
  if (field != beamline.parts.end())
    add(fmt::format("the field `{}` begins at {}, before `{}` at {}: nothing may act before the opening that "
                    "the source is aimed at",
                    field->placement.name, metres(field->placement.at), aimed->target, metres(at)),
        "aim at an opening before the first field, or use `direction: {kind: cone, ...}`");
}

// ---- speeds ----

/// How fast a species flies that is too fast, and how to mend it.
std::pair<std::string, std::string> too_fast(const StatedSpeed& stated, const Species& species) {
  const std::string limit =
      fmt::format("{:.4g} m/s{}, faster than 0.05 c = {:.4g} m/s: this program knows no relativity",
                  speed_of(stated.value, species.mass), stated.is_mean ? " on average" : "", fastest_speed);
  if (stated.is_mean)
    return {fmt::format("at that temperature the species `{}` flies at {}", species.name, limit),
            "make it colder"};
  const Dimension quantity = stated.value.dimension;
  if (quantity == Dimension::speed)
    return {fmt::format("the species `{}` flies at {}", species.name, limit), "make it slower"};
  return {fmt::format("at {} the species `{}` flies at {}", pretty_quantity(stated.value.value, quantity),
                      species.name, limit),
          quantity == Dimension::length ? "make the wavelength longer" : "make the energy smaller"};
}

/// The first species that is too fast, for each key of the distribution.
void check_speeds(const Beamline& beamline, Faults& out) {
  std::vector<std::string> reported;
  for (const Component& component : beamline.species) {
    const Species& species = component.species;
    for (const StatedSpeed& stated : std::visit(
             [&](const auto& law) { return law.stated_speeds(species.mass); }, beamline.source.speed)) {
      if (!(stated.value.value > 0) || speed_of(stated.value, species.mass) <= fastest_speed ||
          std::ranges::count(reported, stated.key) > 0)
        continue;
      auto [message, help] = too_fast(stated, species);
      out.push_back({"source", "speed." + stated.key, std::move(message), std::move(help)});
      reported.push_back(stated.key);
    }
  }
}

/// A normal distribution is normal in one quantity.
void check_gaussian(const SpeedLaw& law, Faults& out) {
  const auto* gaussian = std::get_if<GaussianSpeed>(&law);
  if (gaussian == nullptr || gaussian->mean.dimension == gaussian->sigma.dimension) return;
  const Dimension mean = gaussian->mean.dimension;
  const auto called = [](Dimension d) {
    return d == Dimension::length ? "a wavelength" : with_article(name_of(d));
  };
  out.push_back({"source", "speed.sigma",
                 fmt::format("the mean is {} and sigma is {}: the law is normal in one of them", called(mean),
                             called(gaussian->sigma.dimension)),
                 fmt::format("write sigma like the mean, in a unit such as `{}`",
                             mean == Dimension::length   ? "angstrom"
                             : mean == Dimension::energy ? "meV"
                                                         : "m/s")});
}

// ---- directions ----

constexpr double right_angle = std::numbers::pi / 2;

std::string degrees(double angle) { return fmt::format("{:.4g} deg", angle / right_angle * 90); }

/// Nothing may start backwards.
void check_tilt(const Source& source, Faults& out) {
  if (source.tilt == SourceTilt{}) return;
  const double forward = portable::cos(source.tilt.x) * portable::cos(source.tilt.z);  // y of the axis
  const double tilt = portable::acos(std::clamp(forward, -1.0, 1.0));
  if (tilt >= right_angle - 1e-9) {
    out.push_back({"source", "tilt",
                   fmt::format("the tilt turns the source's axis by {}, off the beam", degrees(tilt)),
                   "tilt it by less than 90 deg"});
    return;
  }
  if (std::holds_alternative<AimedDirection>(source.direction)) return;
  const double angle =
      std::visit([](const auto& law) { return law.widest_angle(farthest_normal); }, source.direction);
  if (tilt + angle < right_angle) return;
  const bool limited = std::visit(
      [](const auto& law) {
        return requires { law.half_angle; };
      },
      source.direction);
  out.push_back(
      {"source", "tilt",
       fmt::format(
           "tilted by {}, the source sends particles backwards: its directions reach {} from the axis",
           degrees(tilt), degrees(angle)),
       limited ? fmt::format("write `half_angle: {}` or less",
                             degrees(std::floor((right_angle - tilt) * 1e3) / 1e3))
               : "tilt it less, or aim it: `direction: {kind: aimed, target: ..., emission: ...}`"});
}

void check_channel(const DirectionLaw& direction, Faults& out) {
  const auto* channel = std::get_if<ChannelDirection>(&direction);
  const auto* aimed = std::get_if<AimedDirection>(&direction);
  if (aimed) channel = std::get_if<ChannelDirection>(&aimed->emission);
  constexpr double longest = 1000;  // [radii]
  if (!channel || channel->length <= longest * channel->radius) return;
  out.push_back({"source", aimed ? "direction.emission.length" : "direction.length",
                 fmt::format("the channel is {:.4g} times as long as its radius, more than {}",
                             channel->length / channel->radius, longest),
                 "such a tube hardly lets anything through; is one of the units wrong?"});
}

/// A ring that is turned inside out.
void check_opening(const Source& source, Faults& out) {
  if (const auto* ring = std::get_if<Ring>(&source.opening))
    for (Fault& fault : faults_of(Opening{*ring}, "source", "opening")) out.push_back(std::move(fault));
}

}  // namespace

void check_source(const Beamline& beamline, Faults& out) {
  check_opening(beamline.source, out);
  check_aim(beamline, out);
  check_speeds(beamline, out);
  check_gaussian(beamline.source.speed, out);
  check_tilt(beamline.source, out);
  check_channel(beamline.source.direction, out);
  check_start_spin(beamline, out);
}

}  // namespace rabiline
