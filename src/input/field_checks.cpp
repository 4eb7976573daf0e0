// Fields that cannot be as they are written.
#include <cmath>

#include "input/check_nodes.hpp"

namespace rabiline {
namespace {

void check_follower(const PlacedPart& part, const RotatingField& zone, const PartNodes& nodes,
                    Reading& reading) {
  const std::string& clock = *zone.oscillator;
  const Place& place = place_in(nodes, part, "oscillator");
  const Node* target = nodes.find(clock);
  std::vector<std::string> clocks = nodes.names({RotatingField::kind});
  std::erase(clocks, part.placement.name);
  if (clock == part.placement.name)
    reading.error(place, fmt::format("`{}` cannot follow its own clock", clock), "leave `oscillator` away");
  else if (!target)
    reading.error(place,
                  fmt::format("there is no rotating_field `{}` whose clock `{}` could follow", clock,
                              part.placement.name),
                  suggest_name(clock, clocks));
  else if (PartNodes::kind_of(*target) != RotatingField::kind)
    reading.error(place,
                  fmt::format("`{}` is a {} and has no clock to follow", clock, PartNodes::kind_of(*target)),
                  suggest_name(clock, clocks));
  else if (const Entry* next = target->find("oscillator"))
    reading.error(place, fmt::format("`{}` follows a clock itself, that of `{}`", clock, next->value.scalar),
                  fmt::format("write `oscillator: {}`", next->value.scalar));
  const Node& node = *nodes.find(part.placement.name);
  for (const std::string_view key : {"frequency", "sense"})
    if (const Entry* entry = node.find(key))
      reading.error(entry->key_place,
                    fmt::format("`{}` has a `{}` of its own, but it follows the clock of `{}`",
                                part.placement.name, key, clock),
                    fmt::format("leave `{}` away, or `oscillator`", key));
  if (zone.phase.kind == Phase::Kind::random)
    reading.error(place_in(nodes, part, "phase"),
                  fmt::format("the phase of `{}` cannot be random: it follows the clock of `{}`",
                              part.placement.name, clock),
                  "write `locked`, or the angle by which it runs ahead");
}

void check_oscillators(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  for (const PlacedPart& part : beamline.parts) {
    const auto* zone = std::get_if<RotatingField>(&part.part);
    if (!zone || !nodes.find(part.placement.name)) continue;
    if (zone->oscillator) {
      check_follower(part, *zone, nodes, reading);
      continue;
    }
    const auto need = [&](std::string_view key, std::string_view example) {
      reading.error(place_in(nodes, part, "kind"),
                    fmt::format("the rotating_field `{}` needs `{}`", part.placement.name, key),
                    fmt::format("add `{}: {}`, or `oscillator` and the name of a zone whose clock it follows",
                                key, example));
    };
    if (!zone->frequency) need("frequency", "291.6 kHz");
    if (!zone->sense) need("sense", "co");
  }
}

/// `co` and `counter` follow the sign of gamma; one field cannot follow two.
void check_senses(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  const Species *positive = nullptr, *negative = nullptr;
  for (const Component& component : beamline.species)
    (component.species.gyromagnetic_ratio < 0 ? negative : positive) = &component.species;
  if (!positive || !negative) return;
  for (const PlacedPart& part : beamline.parts) {
    const auto* zone = std::get_if<RotatingField>(&part.part);
    if (!zone || (zone->sense != Sense::co && zone->sense != Sense::counter)) continue;
    reading.error(
        place_in(nodes, part, "sense"),
        fmt::format("`{}` cannot say which way the field turns: `{}` has a positive and `{}` a negative "
                    "gyromagnetic ratio, so they precess in opposite senses",
                    *zone->sense == Sense::co ? "co" : "counter", positive->name, negative->name),
        fmt::format("write `positive` to drive `{}`, or `negative` to drive `{}`, with the field along +z",
                    negative->name, positive->name));
  }
}

void check_polarizers(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  const auto& parts = beamline.parts;
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const auto *first = std::get_if<Polarizer>(&parts[k].part),
                 *second = std::get_if<Polarizer>(&parts[i].part);
      if (!first || !second) continue;
      const double a = parts[k].placement.at, b = parts[i].placement.at;
      if (a < b + second->length && b < a + first->length)
        reading.error(place_in(nodes, parts[i], "at"),
                      fmt::format("the polarizers `{}` ({} to {}) and `{}` ({} to {}) overlap: only one of "
                                  "them can align the moments",
                                  parts[k].placement.name, metres(a), metres(a + first->length),
                                  parts[i].placement.name, metres(b), metres(b + second->length)),
                      "move one of them along the beam");
    }
}

}  // namespace

void check_fields(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  check_oscillators(beamline, nodes, reading);
  check_senses(beamline, nodes, reading);
  check_polarizers(beamline, nodes, reading);
}

}  // namespace rabiline
