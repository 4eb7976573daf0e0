// Fields that cannot be as they are written.
#include <cmath>

#include "input/check_nodes.hpp"

namespace rabiline {
namespace {

template <class Zone>
void check_follower(const PlacedPart& part, const Zone& zone, const PartNodes& nodes, Reading& reading) {
  const std::string& clock = *zone.oscillator;
  const Place& place = place_in(nodes, part, "oscillator");
  const Node* target = nodes.find(clock);
  std::vector<std::string> clocks = nodes.names({Zone::kind});
  std::erase(clocks, part.placement.name);
  if (clock == part.placement.name)
    reading.error(place, fmt::format("`{}` cannot follow its own clock", clock), "leave `oscillator` away");
  else if (!target)
    reading.error(place,
                  fmt::format("there is no {} `{}` whose clock `{}` could follow", Zone::kind, clock,
                              part.placement.name),
                  suggest_name(clock, clocks));
  else if (PartNodes::kind_of(*target) != Zone::kind)
    reading.error(place,
                  fmt::format("`{}` is a {}, whose clock {} cannot follow", clock,
                              PartNodes::kind_of(*target), with_article(Zone::kind)),
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

template <class Zone>
void check_clock(const PlacedPart& part, const Zone& zone, const PartNodes& nodes, Reading& reading) {
  if (zone.oscillator) return check_follower(part, zone, nodes, reading);
  const auto need = [&](std::string_view key, std::string_view example) {
    reading.error(place_in(nodes, part, "kind"),
                  fmt::format("the {} `{}` needs `{}`", Zone::kind, part.placement.name, key),
                  fmt::format("add `{}: {}`, or `oscillator` and the name of a zone whose clock it follows",
                              key, example));
  };
  if (!zone.frequency) need("frequency", "291.6 kHz");
  if constexpr (requires { zone.sense; })
    if (!zone.sense) need("sense", "co");
}

void check_oscillators(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  for (const PlacedPart& part : beamline.parts) {
    if (!nodes.find(part.placement.name)) continue;
    if (const auto* zone = std::get_if<RotatingField>(&part.part)) check_clock(part, *zone, nodes, reading);
    if (const auto* zone = std::get_if<OscillatingField>(&part.part))
      check_clock(part, *zone, nodes, reading);
  }
}

/// `co` and `counter` follow the sign of gamma; one field cannot follow two.
void check_senses(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  const Species *positive = nullptr, *negative = nullptr;
  const bool quantum = std::holds_alternative<QuantumLaw>(beamline.law);
  for (const Component& component : beamline.species)
    if (!quantum || !component.species.structure)
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

/// A half turn could go either way round.
void check_guides(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  for (const PlacedPart& part : beamline.parts) {
    const auto* guide = std::get_if<GuideField>(&part.part);
    if (guide && dot(guide->from, guide->to) < -1 + 1e-9)
      reading.error(
          place_in(nodes, part, "to"),
          fmt::format("`{}` would turn its field by half a turn: which way round?", part.placement.name),
          "make two guide fields of a quarter turn each");
  }
}

void check_coils(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  if (beamline.species.empty() || beamline.species.front().species.gyromagnetic_ratio != 0) return;
  for (const PlacedPart& part : beamline.parts)
    if (std::holds_alternative<Coil>(part.part))
      reading.error(place_in(nodes, part, "kind"),
                    fmt::format("`{}` cannot turn the spin of {}, which has no magnetic moment",
                                part.placement.name, beamline.species.front().species.name),
                    "a uniform_field has a field of its own");
}

bool turns_paths(const Beamline& beamline) {
  if (const auto* dorado = std::get_if<DoradoLaw>(&beamline.law)) return dorado->kappa != 0;
  return std::any_of(beamline.species.begin(), beamline.species.end(),
                     [](const Component& c) { return c.species.charge != 0; });
}

void check_filters(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  for (const PlacedPart& part : beamline.parts) {
    const bool filters_spins = std::holds_alternative<SpinFilter>(part.part);
    if (!filters_spins && !is_own_stage(part.part)) continue;
    for (const Component& c : beamline.species)
      if (filters_spins && law_traits(beamline.law).has_levels && c.species.spin.twice > 1 &&
          !c.species.structure)
        reading.error(place_in(nodes, part, "kind"),
                      fmt::format("`{}` filters spins 1/2, but {} has another spin", part.placement.name,
                                  c.species.name),
                      "a polarizer prepares a beam of any spin");
    if (!turns_paths(beamline)) continue;
    const double y = part.placement.at;
    const auto field = std::find_if(beamline.parts.begin(), beamline.parts.end(), [&](const PlacedPart& p) {
      return is_field(p.part) && p.placement.at < y && y < end_of(p);
    });
    if (field != beamline.parts.end())
      reading.error(
          place_in(nodes, part, "at"),
          fmt::format("`{}` stands in the field `{}`, which turns the path under this law, and a {} can "
                      "only be passed in one direction",
                      part.placement.name, field->placement.name,
                      filters_spins ? "filter" : PartNodes::kind_of(*nodes.find(part.placement.name))),
          "move it out of the field, or leave it away under this law");
  }
}

/// The wall at one place is the narrowest; two of them with different centres would need both.
void check_bores(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  struct Tube {
    const PlacedPart* part;
    double begin, end, radius;
    Offset offset;
  };
  std::vector<Tube> tubes;
  for (const PlacedPart& part : beamline.parts)
    std::visit(
        [&](const auto& p) {
          const double begin = part.placement.at;
          if constexpr (requires { p.bore; })
            if (p.bore) tubes.push_back({&part, begin, begin + p.length, p.bore->radius, p.offset});
          if constexpr (std::is_same_v<std::decay_t<decltype(p)>, Collimator>)
            if (const auto* disc = std::get_if<Disc>(&p.opening))
              tubes.push_back({&part, begin, begin + p.length, disc->radius, p.offset});
        },
        part.part);
  for (std::size_t i = 0; i < tubes.size(); ++i) {
    const Tube& b = tubes[i];
    for (std::size_t k = 0; k < i; ++k) {
      const Tube& a = tubes[k];
      if (a.begin < b.end && b.begin < a.end && a.offset != b.offset)
        reading.error(
            place_in(nodes, *b.part, "offset"),
            fmt::format("the walls of `{}` and `{}` overlap along the beam and have different centres",
                        a.part->placement.name, b.part->placement.name),
            "give both the same `offset`, or move one of them");
    }
    if (beamline.chamber && b.offset != Offset{} &&
        std::hypot(b.offset.x, b.offset.z) + b.radius > beamline.chamber->radius)
      reading.error(place_in(nodes, *b.part, "offset"),
                    fmt::format("the wall of `{}` reaches out of the chamber, whose radius is {}",
                                b.part->placement.name, metres(beamline.chamber->radius)),
                    "make its bore narrower, or its offset smaller");
  }
}

}  // namespace

void check_fields(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  check_oscillators(beamline, nodes, reading);
  check_senses(beamline, nodes, reading);
  check_polarizers(beamline, nodes, reading);
  check_guides(beamline, nodes, reading);
  check_coils(beamline, nodes, reading);
  check_filters(beamline, nodes, reading);
  check_bores(beamline, nodes, reading);
}

}  // namespace rabiline
